//! mesh/generate
