//! Every key of a scene file.

use crate::scene::contact::{EXCLUDE, FRICTION, THICKNESS, TOUCHING_ALONE};
use crate::scene::{
    BENDING, BENDING_STIFFNESS, DENSITY, LINK_LENGTH, LINK_MASS, LINKS, MEMBRANE, MODULUS, POISSON,
    RIGIDITY, SHEAR, STIFFNESS, TIP_MASS, cloth,
};
use crate::settings::{Parameter, parameter};

/// A table of the file.
#[derive(Clone, Copy, Debug)]
pub struct SectionInfo {
    /// How its head is written; empty for what stands before all heads.
    pub head: &'static str,
    /// What it is.
    pub about: &'static str,
    /// What can stand in it.
    pub keys: &'static [Parameter],
}

pub(super) const NAME: Parameter = parameter("name", "the file's", "of the scene");
pub(super) const GRAVITY: Parameter = parameter(
    "gravity",
    "[0, 0, -9.81]",
    "acceleration of free fall (m/s²); what is up for pins and pictures is its opposite",
);
pub(super) const DT: Parameter = parameter("dt", "1/60", "step size (s), above 0");
pub(super) const STEPS: Parameter = parameter("steps", "300", "number of steps");

pub(super) const FILE: Parameter = parameter(
    "file",
    "none",
    "an OBJ or PLY file in m, its path relative to the scene file",
);
pub(super) const GENERATOR: Parameter = parameter(
    "generator",
    "none",
    "a generated mesh such as \"grid:33x33:alternating\" (see meshes); give this or a file",
);
pub(super) const SCALE: Parameter = parameter(
    "scale",
    "1",
    "factor above 0, or one for each axis such as [1, 0.25, 1]; first of all",
);
pub(super) const ROTATE: Parameter = parameter(
    "rotate",
    "[0, 0, 0]",
    "rotation about the origin (rad): its direction is the axis, its length the angle",
);
pub(super) const TRANSLATE: Parameter =
    parameter("translate", "[0, 0, 0]", "shift (m), last of all");

pub(super) const PRESSURE: Parameter = parameter(
    "pressure",
    "none",
    "gauge pressure (Pa) inside a closed piece; with a bulk_modulus when it has its volume at rest, otherwise always, as if a pump kept it; none: 0",
);
pub(super) const BULK_MODULUS: Parameter = parameter(
    "bulk_modulus",
    "none",
    "K (Pa), above 0, of what is sealed inside a closed piece: its pressure falls by K for every volume at rest that is added; 1e5 for air, 2e9 for water; none: nothing is",
);

pub(super) const LINK_MESHES: Parameter = parameter(
    "meshes",
    "needed",
    "numbers of the two [[mesh]] tables, from 0, that are joined, such as [0, 1]; the same one twice joins a piece to itself",
);
pub(super) const LINK_FIRST: Parameter = parameter(
    "first",
    "none",
    "vertices of the first mesh, from 0 in their own; give first and second, or at",
);
pub(super) const LINK_SECOND: Parameter = parameter(
    "second",
    "none",
    "as many of the second mesh, one for each: a link holds both as far apart as they are at rest",
);
pub(super) const LINK_AT: Parameter = parameter(
    "at",
    "none",
    "a point (m): the nearest vertex of the second mesh is linked to three of the first around it, a ball joint",
);
pub(super) const LINK_STIFFNESS: Parameter = parameter(
    "stiffness",
    "inf",
    "of each link (N/m), above 0, or inf: rigid, with xpbd alone",
);

pub(super) const SELECT: Parameter = parameter(
    "select",
    "none",
    "\"corners\" (the two at one end of a sheet), \"highest\" or \"border\" (all on an edge of one triangle); give this, vertices or a box",
);
pub(super) const VERTICES: Parameter = parameter(
    "vertices",
    "none",
    "numbers from 0, in the order of the file or the generator, mesh after mesh",
);
pub(super) const BOX: Parameter = parameter(
    "box",
    "none",
    "two corners such as [[0, 0, 0], [1, 1, 1]] (m): all vertices in between",
);
pub(super) const MOVE: Parameter = parameter("move", "[0, 0, 0]", "shift (m) within the duration");
pub(super) const TURN: Parameter = parameter(
    "turn",
    "[0, 0, 0]",
    "rotation (rad) within the duration: its direction is the axis, its length the angle, any number of turns",
);
pub(super) const CENTRE: Parameter =
    parameter("centre", "[0, 0, 0]", "a point (m) on the axis of the turn");
pub(super) const DURATION: Parameter = parameter(
    "duration",
    "1",
    "how long shift and turn take (s), above 0, at a constant rate; the pins rest after it",
);

pub(super) const FROM: Parameter = parameter(
    "from",
    "0",
    "time (s) at which the vertices are grabbed, wherever they are then, at least 0; move and turn begin with it",
);
pub(super) const UNTIL: Parameter = parameter(
    "until",
    "none",
    "time (s) at which they are released with the velocity they have, after from; none: never",
);

pub(super) const FORCE: Parameter = parameter(
    "force",
    "needed",
    "on all the chosen vertices together (N), spread over them by their masses",
);
pub(super) const FORCE_FROM: Parameter = parameter(
    "from",
    "0",
    "time (s) from which on it acts, at least 0: in steps that begin then or later",
);
pub(super) const FORCE_UNTIL: Parameter = parameter(
    "until",
    "none",
    "time (s) at which it ends, after from: it acts in steps that begin before; none: never",
);

pub(super) const TEAR_TIME: Parameter = parameter("time", "needed", "of the tear (s), at least 0");
pub(super) const TEAR_BOX: Parameter = parameter(
    "box",
    "needed",
    "two corners such as [[0, 0, 0], [1, 1, 1]] (m): triangles whose middle, at rest, is in between vanish",
);

pub(super) const SEAM_MESHES: Parameter = parameter(
    "meshes",
    "needed",
    "numbers of the two [[mesh]] tables, from 0, whose borders are sewn together, such as [0, 1]; the same one twice sews a piece to itself",
);
pub(super) const FIRST: Parameter = parameter(
    "first",
    "none",
    "vertices of the first chain in the order of the seam, from 0 in their own mesh, all on its border; give this or first_border",
);
pub(super) const FIRST_BORDER: Parameter = parameter(
    "first_border",
    "none",
    "the two ends of the first chain, which goes along the border the shorter way; a number in between says which way, such as [0, 5, 40]",
);
pub(super) const SECOND: Parameter = parameter(
    "second",
    "none",
    "the same of the second chain: as many vertices, each for the one of the first in the same place",
);
pub(super) const SECOND_BORDER: Parameter = parameter(
    "second_border",
    "none",
    "the same of the second chain; its first end is sewn to the first end of the other",
);
pub(super) const SEAM_STIFFNESS: Parameter = parameter(
    "stiffness",
    "none",
    "of the stitch between two vertices (N/m), above 0; none: the stiffness of the cloth's springs, or the modulus that is given in its place, of two pieces the smaller one",
);
pub(super) const SEAM_FROM: Parameter = parameter(
    "from",
    "0",
    "time (s) at which sewing begins, at least 0, whatever the distance between two vertices is then",
);
pub(super) const SEAM_UNTIL: Parameter = parameter(
    "until",
    "none",
    "time (s) at which that distance, which falls at a constant rate, is zero, after from; none: the chains lie on each other at the start",
);

pub(super) const SHAPE: Parameter = parameter(
    "shape",
    "needed",
    "\"sphere\", \"box\", \"capsule\" (along its own z), \"plane\" (up along its own z), \"mesh\" (closed) or \"animation\" (open or closed, moved by its files)",
);
pub(super) const FOLDER: Parameter = parameter(
    "folder",
    "needed",
    "of an animation: OBJ or PLY files in m with the same triangles, one shape each, in the order of their names",
);
pub(super) const INTERVAL: Parameter = parameter(
    "interval",
    "1/60",
    "time between two shapes of an animation (s), above 0; vertices go straight in between",
);
pub(super) const RADIUS: Parameter =
    parameter("radius", "needed", "of a sphere or a capsule (m), above 0");
pub(super) const EXTENT: Parameter =
    parameter("size", "needed", "the three edges of a box (m), above 0");
pub(super) const LENGTH: Parameter = parameter(
    "length",
    "needed",
    "of the straight part of a capsule (m), at least 0",
);
pub(super) const SAMPLED: Parameter = parameter(
    "sampled",
    "none",
    "of a mesh: spacing (m), above 0, of a grid in which its signed distance is looked up, at most 0.87 spacings off; none: it is exact",
);
pub(super) const POSITION: Parameter = parameter(
    "position",
    "[0, 0, 0]",
    "of the middle, or of a point on a plane (m), at the start",
);
pub(super) const VELOCITY: Parameter = parameter(
    "velocity",
    "[0, 0, 0]",
    "constant, or with a density at the start (m/s)",
);
pub(super) const ANGULAR_VELOCITY: Parameter = parameter(
    "angular_velocity",
    "[0, 0, 0]",
    "the same of turning (rad/s), about the position; with a density about the centre of mass",
);
pub(super) const BODY_DENSITY: Parameter = parameter(
    "density",
    "none",
    "of a body that gravity pulls and the cloth pushes (kg/m³), above 0; none: it keeps its velocities, whatever pushes it. It stops, without a rebound and without friction, before held vertices and before other bodies, but for animations; other bodies pass through each other. A run cuts a step into parts that are short enough for the contact of the body",
);

pub(super) const START_VELOCITY: Parameter = parameter(
    "velocity",
    "[0, 0, 0]",
    "of every vertex that is not held (m/s)",
);
pub(super) const WAVE: Parameter = parameter(
    "wave",
    "[0, 0, 0]",
    "amplitude (m) of a shift a sin(2π k·x), so that a flat sheet knows where to buckle",
);
pub(super) const WAVE_NUMBER: Parameter =
    parameter("wave_number", "[0, 0, 0]", "k of the wave (1/m)");

pub(super) const AIR_DENSITY: Parameter = parameter(
    "density",
    "1.2",
    "of the air (kg/m³), at least 0; 1.2 at sea level",
);
pub(super) const DRAG: Parameter = parameter(
    "drag",
    "1.2",
    "coefficient C_D of the force along the flow, at least 0; a plate has about 1.2",
);
pub(super) const LIFT: Parameter = parameter(
    "lift",
    "0",
    "coefficient C_L of the force across the flow, at least 0, and 0 without drag",
);
pub(super) const WIND: Parameter = parameter("wind", "[0, 0, 0]", "velocity of the wind (m/s)");

/// Keys of `[cloth]`, which are those of `--set`.
const CLOTH: &[Parameter] = &[
    DENSITY,
    STIFFNESS,
    MODULUS,
    MEMBRANE,
    POISSON,
    SHEAR,
    cloth::COMPRESSION,
    cloth::SLACK,
    cloth::EDGES,
    cloth::LEVEL,
    cloth::FINE_SHARE,
    RIGIDITY,
    BENDING,
    BENDING_STIFFNESS,
];

/// Below a `[[mesh]]`.
pub(super) const MESH_CLOTH: SectionInfo = SectionInfo {
    head: "[mesh.cloth]",
    about: "below a [[mesh]]: what is different of the material of this piece, which --set leaves as it is",
    keys: CLOTH,
};

/// Below a `[[mesh]]`.
pub(super) const MESH_CONTACT: SectionInfo = SectionInfo {
    head: "[mesh.contact]",
    about: "below a [[mesh]]: what is different of the contact of this piece, which --set leaves as it is; two pieces keep half the sum \
            of their thicknesses, and have the geometric mean of their coefficients of friction, a piece and an obstacle too",
    keys: &[THICKNESS, FRICTION, EXCLUDE],
};

/// Every table, in the order in which one would write them.
pub const SECTIONS: [SectionInfo; 15] = [
    SectionInfo {
        head: "",
        about: "before all tables",
        keys: &[NAME, GRAVITY, DT, STEPS],
    },
    SectionInfo {
        head: "[[mesh]]",
        about: "the cloth at rest; several make one cloth of several pieces",
        keys: &[
            FILE,
            GENERATOR,
            SCALE,
            ROTATE,
            TRANSLATE,
            PRESSURE,
            BULK_MODULUS,
        ],
    },
    MESH_CLOTH,
    MESH_CONTACT,
    SectionInfo {
        head: "[cloth]",
        about: "the material",
        keys: CLOTH,
    },
    SectionInfo {
        head: "[[pins]]",
        about: "held vertices, which may move, for some time or for ever",
        keys: &[
            SELECT, VERTICES, BOX, MOVE, TURN, CENTRE, DURATION, FROM, UNTIL,
        ],
    },
    SectionInfo {
        head: "[[force]]",
        about: "a constant force on chosen vertices, for some time or for ever",
        keys: &[SELECT, VERTICES, BOX, FORCE, FORCE_FROM, FORCE_UNTIL],
    },
    SectionInfo {
        head: "[[tear]]",
        about: "triangles that are torn out; their mass stays with their corners",
        keys: &[TEAR_TIME, TEAR_BOX],
    },
    SectionInfo {
        head: "[[seam]]",
        about: "two chains of border vertices that are drawn together, and then held together",
        keys: &[
            SEAM_MESHES,
            FIRST,
            FIRST_BORDER,
            SECOND,
            SECOND_BORDER,
            SEAM_STIFFNESS,
            SEAM_FROM,
            SEAM_UNTIL,
        ],
    },
    SectionInfo {
        head: "[[link]]",
        about: "links between vertices, as long as at rest: chains, joints, ragdolls",
        keys: &[
            LINK_MESHES,
            LINK_FIRST,
            LINK_SECOND,
            LINK_AT,
            LINK_STIFFNESS,
        ],
    },
    SectionInfo {
        head: "[start]",
        about: "where the cloth starts, unless at rest",
        keys: &[START_VELOCITY, WAVE, WAVE_NUMBER],
    },
    SectionInfo {
        head: "[air]",
        about: "the air that brakes and blows; without this table there is none",
        keys: &[AIR_DENSITY, DRAG, LIFT, WIND],
    },
    SectionInfo {
        head: "[[obstacle]]",
        about: "a body that the cloth can touch",
        keys: &[
            SHAPE,
            RADIUS,
            EXTENT,
            LENGTH,
            FILE,
            GENERATOR,
            SCALE,
            FOLDER,
            INTERVAL,
            SAMPLED,
            POSITION,
            ROTATE,
            VELOCITY,
            ANGULAR_VELOCITY,
            BODY_DENSITY,
        ],
    },
    SectionInfo {
        head: "[contact]",
        about: "how the cloth touches obstacles and itself",
        keys: TOUCHING_ALONE,
    },
    SectionInfo {
        head: "[chain]",
        about: "a chain of links in the place of everything else but what stands before all tables",
        keys: &[LINKS, LINK_LENGTH, LINK_MASS, TIP_MASS, STIFFNESS],
    },
];

/// Keys that `--set` overrules.
#[must_use]
pub fn overrulable() -> [&'static [Parameter]; 2] {
    [CLOTH, TOUCHING_ALONE]
}
