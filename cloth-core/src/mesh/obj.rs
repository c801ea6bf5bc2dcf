//! mesh/obj
