//! Blocks seen from far away: parallel projection, back faces left out, the nearer block drawn last.

use super::shapes::{Metres, metres};
use super::svg::{At, INK, Svg, shaded};
use rockproof_model::{Block, FaceId, VertexId};

/// Where a picture is seen from, and where on the page it goes. No trigonometry: a direction and square roots give the
/// same bits everywhere.
pub(super) struct Camera {
    right: Metres,
    up: Metres,
    towards: Metres,
    /// Page position of the point (0, 0, 0).
    pub(super) origin: At,
    /// Pixels per metre.
    pub(super) scale: f64,
}

impl Camera {
    /// A camera in the direction `towards` from the scene, z upwards.
    pub(super) fn new(towards: Metres, origin: At, scale: f64) -> Camera {
        let towards = unit(towards);
        let right = unit([-towards[1], towards[0], 0.0]);
        Camera { right, up: cross(towards, right), towards, origin, scale }
    }

    /// The page position of a point.
    pub(super) fn at(&self, point: Metres) -> At {
        (self.origin.0 + self.scale * dot(self.right, point), self.origin.1 - self.scale * dot(self.up, point))
    }

    /// Whether the side of a face that its normal points to can be seen.
    pub(super) fn sees(&self, normal: Metres) -> bool {
        dot(self.towards, normal) > 0.0
    }

    /// Draws the faces of a convex block that face the camera; `tint` replaces the colour of one of them.
    pub(super) fn block(&self, svg: &mut Svg, block: &Block, colour: [u8; 3], tint: Option<(FaceId, &str)>) {
        for (f, corners) in (0..).map(FaceId).zip(block.topology().faces()) {
            let normal = normal_of(block, f);
            if !self.sees(normal) {
                continue;
            }
            let points: Vec<At> = corners.iter().map(|&v| self.at(vertex(block, v))).collect();
            let light = 0.62 + 0.38 * dot(unit(normal), unit([-1.0, -2.0, 5.0])).max(0.0);
            match tint {
                Some((face, fill)) if face == f => svg.polygon(&points, fill, INK),
                _ => svg.polygon(&points, &shaded(colour, light), INK),
            }
        }
    }
}

/// A vertex in f64.
pub(super) fn vertex(block: &Block, vertex: VertexId) -> Metres {
    metres(&block.vertices()[vertex.index()])
}

/// The outward normal of a face, of any length.
pub(super) fn normal_of(block: &Block, face: FaceId) -> Metres {
    let corners = block.topology().face(face);
    let [a, b, c] = [0, 1, 2].map(|k| vertex(block, corners[k]));
    cross(minus(b, a), minus(c, b))
}

/// `a + b`
pub(super) fn plus(a: Metres, b: Metres) -> Metres {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a − b`
pub(super) fn minus(a: Metres, b: Metres) -> Metres {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `factor · a`
pub(super) fn scaled(a: Metres, factor: f64) -> Metres {
    a.map(|c| c * factor)
}

/// `a · b`
pub(super) fn dot(a: Metres, b: Metres) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a × b`
pub(super) fn cross(a: Metres, b: Metres) -> Metres {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a / |a|`
pub(super) fn unit(a: Metres) -> Metres {
    scaled(a, 1.0 / dot(a, a).sqrt())
}
