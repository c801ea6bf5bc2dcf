//! The bending models by name, for every law and study that compares them.

use super::prelude::*;
use crate::settings::Choice;
use cloth_core::energy::{CubicShell, CurvatureHinge, CurvedHinge, DihedralHinge};
use cloth_core::math::gather;

/// A bending model with its own coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Model {
    Bergou,
    Curved,
    Grinspun,
    Bridson,
    Cubic,
}

/// Every model, by the name that results are shown under.
pub(crate) const MODELS: [(&str, Model); 5] = [
    ("bergou", Model::Bergou),
    ("curved", Model::Curved),
    ("grinspun", Model::Grinspun),
    ("bridson", Model::Bridson),
    ("cubic", Model::Cubic),
];

impl Choice for Model {
    /// The same and other names for them.
    const NAMES: &'static [(&'static str, Self)] = &[
        MODELS[0],
        MODELS[1],
        MODELS[2],
        MODELS[3],
        MODELS[4],
        ("quadratic", Model::Bergou),
        ("dihedral", Model::Grinspun),
    ];
}

crate::settings! {
    /// Of laws of bending models.
    pub(super) struct ModelSetting {
        model: Model = "bergou", "bergou or quadratic; curved (cotangent form); grinspun or dihedral; bridson; cubic";
    }
}

impl Model {
    /// The model that results are shown under this name of.
    pub(crate) fn named(name: &str) -> Self {
        let found = MODELS.iter().find(|(known, _)| *known == name);
        found.expect("a name of `MODELS`").1
    }

    /// Energy of a small fold over that of the quadratic model with the same coefficient.
    pub(crate) fn factor(self) -> Real {
        match self {
            Self::Bergou | Self::Curved | Self::Cubic => 1.0,
            Self::Grinspun => 2.0,
            Self::Bridson => 1.0 / 12.0,
        }
    }

    /// The coefficient (N·m) for a cylindrical rigidity D (N·m).
    pub(crate) fn coefficient(self, rigidity: Real) -> Real {
        match self {
            Self::Bergou | Self::Curved => CurvatureHinge::coefficient(rigidity),
            Self::Grinspun => DihedralHinge::grinspun_coefficient(rigidity),
            Self::Bridson => DihedralHinge::bridson_coefficient(rigidity),
            Self::Cubic => CubicShell::coefficient(rigidity),
        }
    }

    /// Its elements with coefficient `k` (N·m) on some hinges, at rest at `rest` (m).
    pub(crate) fn elements(self, rest: &[Vec3], hinges: &[[u32; 4]], k: Real) -> Elements {
        let each = hinges.iter().map(|&h| (h, gather(rest, h)));
        match self {
            Self::Bergou => {
                Elements::Quadratic(each.map(|(h, x)| CurvatureHinge::new(h, &x, k)).collect())
            }
            Self::Curved => {
                Elements::Curved(each.map(|(h, x)| CurvedHinge::new(h, &x, k)).collect())
            }
            Self::Grinspun => Elements::Dihedral(
                each.map(|(h, x)| DihedralHinge::grinspun(h, &x, k))
                    .collect(),
            ),
            Self::Bridson => Elements::Dihedral(
                each.map(|(h, x)| DihedralHinge::bridson(h, &x, k))
                    .collect(),
            ),
            Self::Cubic => Elements::Cubic(each.map(|(h, x)| CubicShell::new(h, &x, k)).collect()),
        }
    }
}
