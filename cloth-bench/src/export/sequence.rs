//! One mesh file a frame.

use super::{Folder, Frame, Writer};
use crate::error::BenchError;
use cloth_core::math::Vec3;
use cloth_core::mesh::ply::{self, Encoding};
use cloth_core::mesh::{obj, vertex_normals};

/// Kinds of mesh files.
pub(super) enum Sequence {
    Obj,
    Ply,
}

impl Sequence {
    fn extension(&self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
        }
    }

    /// A mesh, in a format that has room for it with vectors at its vertices.
    fn bytes(
        &self,
        positions: &[Vec3],
        vectors: &[(&str, &[Vec3])],
        triangles: &[[u32; 3]],
    ) -> Vec<u8> {
        match self {
            Self::Obj => {
                let normals = vertex_normals(positions, triangles);
                obj::format_smooth(positions, &normals, triangles).into_bytes()
            }
            Self::Ply => {
                ply::format_with(positions, vectors, triangles, Encoding::BinaryLittleEndian)
            }
        }
    }
}

impl Writer for Sequence {
    fn frame(&mut self, frame: &Frame<'_>, folder: &mut Folder) -> Result<(), BenchError> {
        let (step, extension) = (frame.step, self.extension());
        let cloth = self.bytes(&frame.positions, &frame.force_vectors(), frame.triangles);
        folder.write(&format!("{step:05}.{extension}"), &[&cloth])?;
        for body in &frame.obstacles {
            let name = match body.is_still {
                true if frame.index > 0 => continue,
                true => format!("{}.{extension}", body.name()),
                false => format!("{}_{step:05}.{extension}", body.name()),
            };
            folder.write(&name, &[&self.bytes(&body.positions, &[], body.triangles)])?;
        }
        Ok(())
    }

    fn finish(&mut self, _: &mut Folder) -> Result<(), BenchError> {
        Ok(())
    }
}
