//! Every key of a scene file.

use crate::scene::Chain;
use crate::scene::cloth::{EdgeSprings, Material, Stiffness};
use crate::scene::contact::{Contact, Surface};
use crate::settings::{Factors, Infinite, Or, Parameter, Range::*, Table};
use cloth_core::math::{Real, Vec3};

/// A table of the file.
#[derive(Clone, Copy, Debug)]
pub struct SectionInfo {
    /// How its head is written; empty for what stands before all heads.
    pub head: &'static str,
    /// What it is.
    pub about: &'static str,
    /// What can stand in it, in groups.
    pub keys: &'static [&'static [Parameter]],
}

/// Lengths (m), masses (kg) and densities (kg/m³) from here on are slips of the pen: a run ends where a coordinate is
/// beyond it, and products of far larger ones are no numbers.
const MOST: Real = 1e9;

crate::settings! {
    /// Before all tables.
    pub(super) struct Top {
        name: Option<String> = "the file's", "of the scene";
        gravity: Option<Vec3> = "[0, 0, -9.81]" "m/s²",
            "acceleration of free fall; what is up for pins and pictures is its opposite";
        dt: Option<Real> = "1/60" "s" in Above(0.0), "step size";
        steps: Option<u32> = 300, "number of steps";
    }
    /// Of a mesh that is read or generated.
    pub(super) struct Source {
        file: Option<String> = "none",
            "an OBJ or PLY file in m, its path relative to the scene file; of a solid, a .msh file of Gmsh";
        generator: Option<String> = "none",
            "a generated mesh such as \"grid:33x17:alternating\", 1 m wide and 16/32 m high (list has all of them); give \
             this or a file";
        scale: Option<Factors> = 1 in Above(0.0), "factor, or one for each axis such as [1, 0.25, 1]; first of all";
    }
    /// Of a piece of cloth.
    pub(super) struct Piece {
        rotate: Option<Vec3> = "[0, 0, 0]" "rad",
            "rotation about the origin: its direction is the axis, its length the angle";
        translate: Option<Vec3> = "[0, 0, 0]" "m" in Within(-MOST, MOST), "shift, last of all";
        weld: Option<Real> = "none" "m" in AtLeast(0.0),
            "vertices no farther from each other, after the scale, become the one with the lowest number; those \
             after it move up";
        pressure: Option<Real> = "none" "Pa",
            "gauge pressure inside a closed piece; with a bulk_modulus when it has its volume at rest, otherwise \
             always, as if a pump kept it; none: 0";
        bulk_modulus: Option<Real> = "none" "Pa" in Above(0.0),
            "K of what is sealed inside a closed piece: its pressure falls by K for every volume at rest that is \
             added; 1e5 for air, 2e9 for water; none: nothing is";
    }
    /// Of a solid.
    pub(super) struct SolidTable {
        density: Real = 1000 "kg/m³" in Between(0.0, MOST), "of the solid; 1000 as water";
        modulus: Real = 1e5 "Pa" in AtLeast(0.0), "Young's modulus E; 1e4 to 1e6 for foam, jelly and soft rubber";
        poisson: Real = 0 in Within(0.0, MOST_POISSON),
            "Poisson's ratio ν; with another one than 0 pd cannot take it, and beyond 0.4 a coarse solid is too stiff";
    }
    /// Of a piece that is not equally thick or rough.
    pub(super) struct PieceContact {
        exclude: Option<Vec<u32>> = "none",
            "numbers of the [[mesh]] tables, from 0, that this piece passes through freely; with its own number, \
             itself";
    }
    /// Of a `[[link]]`.
    pub(super) struct Link {
        meshes: Option<Vec<u32>> = "needed",
            "numbers of the two [[mesh]] tables, from 0, that are joined, such as [0, 1]; the same one twice joins a \
             piece to itself";
        first: Option<Vec<u32>> = "none",
            "vertices of the first mesh, from 0 in their own; give first and second, or at";
        second: Option<Vec<u32>> = "none",
            "as many of the second mesh, one for each: a link holds both as far apart as they are at rest";
        at: Option<Vec3> = "none" "m",
            "a point: the nearest vertex of the second mesh is linked to three of the first around it, a ball joint";
        stiffness: Or<Infinite, Real> = "inf" "N/m" in Above(0.0), "of each link, or inf: rigid, with xpbd alone";
        slack: bool = "no", "whether a link pulls alone, as a rope, and does not push: yes (of a finite stiffness) or no";
    }
    /// Vertices by name, number or place.
    pub(super) struct Selection {
        mesh: Option<u32> = "none",
            "number of the [[mesh]] table, from 0, whose vertices (of a tear, triangles) alone are chosen; none: all";
        select: Option<String> = "none",
            "\"corners\" (of a level sheet, from a file or a generator, the two at its end of the largest y; where \
             up is y, of the smallest z; where up is x, of the largest z), \"highest\" or \"border\" (all on an edge \
             of one triangle); give this, vertices or a box";
        vertices: Option<Vec<u32>> = "none",
            "numbers from 0, in the order of the file or the generator, in the given mesh or mesh after mesh";
        corners as "box": Option<[Vec3; 2]> = "none" "m",
            "two corners such as [[0, 0, 0], [1, 1, 1]]: all vertices in between, at rest, whenever \
             what they are chosen for begins";
    }
    /// Of vertices that are held and move.
    pub(super) struct Way {
        shift as "move": Option<Vec3> = "[0, 0, 0]" "m", "shift within the duration";
        turn: Option<Vec3> = "[0, 0, 0]" "rad",
            "rotation within the duration: its direction is the axis, its length the angle, any number of turns";
        centre: Option<Vec3> = "[0, 0, 0]" "m", "a point on the axis of the turn";
        duration: Real = 1 "s" in Above(0.0),
            "how long shift and turn take, at a constant rate; the vertices rest after it";
    }
    /// Of `[[pins]]`.
    pub(super) struct Hold {
        stiffness: Or<Infinite, Real> = "inf" "N/m" in Above(0.0),
            "of the spring by which each vertex is tied to the place where it would be held, or inf: it is there";
        from: Real = 0 "s" in AtLeast(0.0),
            "time at which the vertices are grabbed, wherever they are then; move and turn begin with it";
        until: Option<Real> = "none" "s" in AtLeast(0.0),
            "time at which they are released with the velocity they have, after from; none: never";
        obstacle: Option<u32> = "none",
            "number of the [[obstacle]] table, from 0, of a body that takes them along from where they are, and has no \
             mass: as part of it if it is rigid, or fixed to the nearest triangle of an animation; in the place of move \
             and turn, and without a spring";
    }
    /// Of a `[[mass]]`.
    pub(super) struct Mass {
        mass: Option<Real> = "needed" "kg" in Between(0.0, MOST),
            "of all the chosen vertices together, spread over them evenly";
    }
    /// Of a `[[force]]`.
    pub(super) struct Force {
        force: Option<Vec3> = "needed" "N", "on all the chosen vertices together, spread over them by their masses";
        from: Real = 0 "s" in AtLeast(0.0), "time from which on it acts: in steps that begin then or later";
        until: Option<Real> = "none" "s" in AtLeast(0.0),
            "time at which it ends, after from: it acts in steps that begin before; none: never";
    }
    /// Of an `[[event]]`.
    pub(super) struct Event {
        time: Option<Real> = "needed" "s" in AtLeast(0.0), "when: before the first step that begins then or later";
        deed as "do": Option<Deed> = "needed",
            "\"grab\" (the chosen vertices are held from now on, wherever they are; with a move or a turn they go \
             on), \"drag\" (those that are held move and turn from where they are), \"release\" (those that are \
             held, with the velocity they have), \"tear\" (triangles vanish: those that a line crosses, or whose \
             middle, at rest, is in a box; refused if a vertex would be left without any) or \"drive\" (a body has \
             the given velocities from now on, and stands still without any)";
        obstacle: Option<u32> = "none",
            "of a drive: number of the [[obstacle]] table, from 0, of a body that moves as it is told";
        velocity: Option<Vec3> = "[0, 0, 0]" "m/s", "of that body";
        angular_velocity: Option<Vec3> = "[0, 0, 0]" "rad/s", "of that body, about its position";
        line: Option<[Vec3; 2]> = "none" "m",
            "of a tear: its two ends, at rest; along edges it takes the triangles to its left";
    }
    /// Of a `[[seam]]`.
    pub(super) struct Seam {
        meshes: Option<Vec<u32>> = "needed",
            "numbers of the two [[mesh]] tables, from 0, whose borders are sewn together, such as [0, 1]; the same one \
             twice sews a piece to itself";
        first: Option<Vec<u32>> = "none",
            "vertices of the first chain in the order of the seam, from 0 in their own mesh, all on its border; give \
             this or first_border";
        first_border: Option<Vec<u32>> = "none",
            "the two ends of the first chain, which goes along the border the shorter way; a number in between says \
             which way, such as [0, 5, 40]; the same end twice is all of the border, such as [0, 5, 0]";
        second: Option<Vec<u32>> = "none",
            "the same of the second chain: as many vertices, each for the one of the first in the same place; of \
             another number the vertices of the chain that has more are sewn to the points of the other at the same \
             fraction of its length";
        second_border: Option<Vec<u32>> = "none",
            "the same of the second chain; its first end is sewn to the first end of the other";
        stiffness: Option<Real> = "none" "N/m" in Above(0.0),
            "of the stitch at each vertex; none: the stiffness of the cloth's springs, or the modulus that is \
             given in its place, of two pieces the smaller one";
        from: Real = 0 "s" in AtLeast(0.0),
            "time at which sewing begins, whatever the distance of a vertex from what it is sewn to is then";
        until: Option<Real> = "none" "s" in AtLeast(0.0),
            "time at which that distance, which falls at a constant rate, is zero, after from; none: the chains lie on \
             each other at the start";
    }
    /// Of an `[[obstacle]]`.
    pub(super) struct Obstacle {
        shape: Option<Shape> = "needed",
            "\"sphere\", \"box\", \"capsule\" (along its own z), \"plane\" (up along its own z), \"mesh\" (closed; an \
             open one, or one through itself, has no inside: its triangles alone keep the cloth on the side where it \
             is) or \"animation\" (open or closed, moved by its files)";
        radius: Option<Real> = "needed" "m" in Between(0.0, MOST), "of a sphere or a capsule";
        size: Option<Vec3> = "needed" "m" in Between(0.0, MOST), "the three edges of a box";
        length: Option<Real> = "needed" "m" in Within(0.0, MOST), "of the straight part of a capsule";
        folder: Option<String> = "needed",
            "of an animation: OBJ or PLY files in m with the same triangles, one shape each, in the order of the \
             numbers in their names (2.obj before 10.obj), all of which have one, or none, and then by name";
        interval: Option<Real> = "1/60" "s" in Above(0.0),
            "time between two shapes of an animation; vertices go straight in between";
        sampled: Option<Real> = "none" "m" in Above(0.0),
            "of a mesh: spacing of a grid in which its signed distance is looked up, a quarter of a spacing off at edges; none: \
             it is exact";
        position: Option<Vec3> = "[0, 0, 0]" "m" in Within(-MOST, MOST), "of the middle, or of a point on a plane, at the start";
        rotate: Option<Vec3> = "[0, 0, 0]" "rad",
            "rotation about the origin: its direction is the axis, its length the angle";
        velocity: Option<Vec3> = "[0, 0, 0]" "m/s", "constant, or with a density or a mass at the start";
        angular_velocity: Option<Vec3> = "[0, 0, 0]" "rad/s",
            "the same of turning, about the position; with a density or a mass about the centre of mass";
        friction: Option<Real> = "that of [contact]" in AtLeast(0.0), "coefficient of friction of the cloth on it; of two bodies, \
             one of which the cloth pushes, the geometric mean";
        released: Option<Real> = "none" "s" in AtLeast(0.0),
            "of a body with a density or a mass: when it is let go, from rest; until then it stays where it is, \
             whatever pushes it; none: it is free from the start";
        density: Option<Real> = "none" "kg/m³" in Between(0.0, MOST),
            "of a body that gravity pulls and the cloth pushes; none: it keeps its velocities, whatever pushes it. It \
             stops, without a rebound and with friction, before held vertices and before other bodies, but for \
             animations; other bodies pass through each other. A run cuts a step into parts that are short enough for \
             the contact of the body";
        mass: Option<Real> = "none" "kg" in Between(0.0, MOST), "the same body by its mass: give this or a density";
        inertia: Option<Vec3> = "none" "kg·m²" in Above(0.0),
            "of such a body about its centre of mass, along the axes of its shape; none: that of a shape which is \
             filled evenly, about its own centre of mass";
        centre: Option<Vec3> = "none" "m",
            "of mass of such a body, from its position, in the axes of its shape; none: that of a shape which is \
             filled evenly";
    }
}

crate::choices! {
    /// Of an obstacle.
    #[derive(PartialEq)]
    pub(super) enum Shape {
        Sphere = "sphere",
        Box = "box",
        Capsule = "capsule",
        Plane = "plane",
        Mesh = "mesh",
        Animation = "animation",
    }
}

crate::choices! {
    /// Of an event.
    #[derive(PartialEq)]
    pub(super) enum Deed { Grab = "grab", Drag = "drag", Release = "release", Tear = "tear", Drive = "drive" }
}

crate::settings! {
    /// Of `[start]`.
    pub(super) struct Start {
        positions: Option<String> = "none",
            "an OBJ or PLY file in m, such as an exported step: where all vertices are, in the order of the meshes; \
             held ones are held there";
        velocity: Option<Vec3> = "[0, 0, 0]" "m/s", "of every vertex that is not held";
        wave: Option<Vec3> = "[0, 0, 0]" "m",
            "amplitude of a shift a sin(2π k·x), so that a flat sheet knows where to buckle; it stretches the sheet by \
             up to √(1 + (2π k a)²) − 1, and should hardly do so";
        wave_number: Option<Vec3> = "[0, 0, 0]" "1/m", "k of the wave";
    }
    /// Of `[air]`.
    pub(super) struct AirTable {
        density: Option<Real> = 1.2 "kg/m³", "of the air; 1.2 at sea level";
        drag: Option<Real> = 1.2, "coefficient C_D of the force along the flow, at least 0; a plate has about 1.2";
        lift: Option<Real> = 0, "coefficient C_L of the force across the flow, at least 0, and 0 without drag";
        wind: Option<Vec3> = "[0, 0, 0]" "m/s", "velocity of the wind";
    }
}

/// Keys of `[cloth]`, which are those of `--set`.
pub(super) const CLOTH: &[&[Parameter]] = &[
    Stiffness::PARAMETERS,
    Material::PARAMETERS,
    EdgeSprings::PARAMETERS,
];

/// Keys of `[contact]`, which are those of `--set`.
const CONTACT: &[&[Parameter]] = &[Surface::PARAMETERS, Contact::PARAMETERS];

/// Below a `[[mesh]]`.
pub(super) const MESH_CLOTH: SectionInfo = SectionInfo {
    head: "[mesh.cloth]",
    about: "below a [[mesh]]: what is different of the material of this piece, which --set leaves as it is; its modulus \
            or stiffness takes the place of either in [cloth]",
    keys: CLOTH,
};

/// Beyond this a solid hardly has a way to move but as a whole.
const MOST_POISSON: Real = 0.49;

/// Below a `[[mesh]]`.
pub(super) const MESH_SOLID: SectionInfo = SectionInfo {
    head: "[mesh.solid]",
    about: "below a [[mesh]] that is a solid of tetrahedra, from block:NxMxK, ball:N or a file of Gmsh (.msh, version \
            2.2 in ASCII): what it is made of; its surface touches as cloth does. It cannot be torn, nor be with [air]",
    keys: &[SolidTable::PARAMETERS],
};

/// Below a `[[mesh]]`.
pub(super) const MESH_CONTACT: SectionInfo = SectionInfo {
    head: "[mesh.contact]",
    about: "below a [[mesh]]: what is different of the contact of this piece, which --set leaves as it is; two pieces keep half the sum \
            of their thicknesses, and have the geometric mean of their coefficients of friction, a piece and an obstacle too",
    keys: &[Surface::PARAMETERS, PieceContact::PARAMETERS],
};

/// For every method.
pub(super) const METHOD: SectionInfo = SectionInfo {
    head: "[method.NAME]",
    about: "such as [method.pd]: settings of a method, with the keys that --set takes for it (see list) and overrules; \
            run reads that of its method, and all of them are checked",
    keys: &[],
};

/// Every table, in the order in which one would write them.
pub const SECTIONS: [SectionInfo; 18] = [
    SectionInfo {
        head: "",
        about: "before all tables",
        keys: &[Top::PARAMETERS],
    },
    SectionInfo {
        head: "[[mesh]]",
        about: "the cloth at rest; several make one cloth of several pieces",
        keys: &[Source::PARAMETERS, Piece::PARAMETERS],
    },
    MESH_CLOTH,
    MESH_SOLID,
    MESH_CONTACT,
    SectionInfo {
        head: "[cloth]",
        about: "the material",
        keys: CLOTH,
    },
    SectionInfo {
        head: "[[pins]]",
        about: "held vertices, which may move, for some time or for ever",
        keys: &[Selection::PARAMETERS, Way::PARAMETERS, Hold::PARAMETERS],
    },
    SectionInfo {
        head: "[[mass]]",
        about: "masses on chosen vertices, beside that of the cloth: a weighted hem",
        keys: &[Selection::PARAMETERS, Mass::PARAMETERS],
    },
    SectionInfo {
        head: "[[force]]",
        about: "a constant force on chosen vertices, for some time or for ever",
        keys: &[Selection::PARAMETERS, Force::PARAMETERS],
    },
    SectionInfo {
        head: "[[event]]",
        about: "what happens at a time: vertices are grabbed, dragged and released, bodies driven, triangles torn \
                out; of these the mass stays with their corners, and what is inside a closed piece escapes; no tear \
                of a cloth with a coarse level, which carries a whole mesh",
        keys: &[Event::PARAMETERS, Selection::PARAMETERS, Way::PARAMETERS],
    },
    SectionInfo {
        head: "[[seam]]",
        about: "two chains of border vertices that are drawn together, and then held together; two vertices that \
                two tables sew together are left to the first",
        keys: &[Seam::PARAMETERS],
    },
    SectionInfo {
        head: "[[link]]",
        about: "links between vertices, as long as at rest: chains, joints, ragdolls",
        keys: &[Link::PARAMETERS],
    },
    SectionInfo {
        head: "[start]",
        about: "where the cloth starts, unless at rest",
        keys: &[Start::PARAMETERS],
    },
    SectionInfo {
        head: "[air]",
        about: "the air that brakes and blows; without this table there is none",
        keys: &[AirTable::PARAMETERS],
    },
    SectionInfo {
        head: "[[obstacle]]",
        about: "a body that the cloth can touch",
        keys: &[Source::PARAMETERS, Obstacle::PARAMETERS],
    },
    SectionInfo {
        head: "[contact]",
        about: "how the cloth touches obstacles and itself",
        keys: CONTACT,
    },
    SectionInfo {
        head: "[chain]",
        about: "a chain of links in the place of everything else but what stands before all tables",
        keys: &[Chain::PARAMETERS, Stiffness::PARAMETERS],
    },
    METHOD,
];

/// Keys that `--set` overrules.
#[must_use]
pub fn overrulable() -> Vec<&'static [Parameter]> {
    [CLOTH, CONTACT].concat()
}
