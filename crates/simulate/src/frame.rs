//! A state as pictures: the blocks, and the contacts as points.

use crate::f64_vector::{Point, cross, dot, minus, point};
use rockproof_model::vtu_writer::{Cells, DataArray, Polyhedra, SCALAR, UnstructuredGrid, VECTOR};
use rockproof_model::{Scene, Topology};
use rockproof_stepper::dynamics::{ContactState, State};
use rockproof_stepper::{Real, Vector};

/// VTK's order of a symmetric tensor.
const TENSOR: &[&str] = &["XX", "YY", "ZZ", "XY", "YZ", "XZ"];
/// Where (σx, σy, σz, τyz, τzx, τxy) stand in that order.
const VTK_ORDER: [usize; 6] = [0, 1, 2, 5, 3, 4];
/// The two blocks of a contact.
const BLOCKS: &[&str] = &["A", "B"];

/// Volume (m³) and centroid (m), by tetrahedra from the first vertex to the fans of the faces.
pub(crate) fn volume_and_centroid(topology: &Topology, points: &[Point]) -> (f64, Point) {
    let (mut six_volumes, mut moment) = (0.0, [0.0; 3]);
    for face in topology.faces() {
        let at = |k: usize| minus(points[face[k].index()], points[0]);
        for k in 1..face.len() - 1 {
            let (a, b, c) = (at(0), at(k), at(k + 1));
            let weight = dot(a, cross(b, c));
            six_volumes += weight;
            for (axis, sum) in moment.iter_mut().enumerate() {
                *sum += weight * (a[axis] + b[axis] + c[axis]);
            }
        }
    }
    let centroid = std::array::from_fn(|axis| points[0][axis] + moment[axis] / (4.0 * six_volumes));
    (six_volumes / 6.0, centroid)
}

/// The rate of displacement at X from the centroid: T(X)·v of SPEC section 5.
fn rate(v: &[f64; 12], [x, y, z]: Point) -> Point {
    let [u, w, q, rx, ry, rz, ex, ey, ez, gyz, gzx, gxy] = *v;
    [
        u + z * ry - y * rz + x * ex + (z * gzx + y * gxy) / 2.0,
        w - z * rx + x * rz + y * ey + (z * gyz + x * gxy) / 2.0,
        q + y * rx - x * ry + z * ez + (y * gyz + x * gzx) / 2.0,
    ]
}

/// The blocks as polyhedra. On points: displacement since `begin` (m) and velocity (m/s). On cells: block number, unknowns
/// (12 deformable, 6 rigid, 0 fixed), volume (m³), velocity of the centroid (m/s), angular velocity (rad/s), stress (Pa,
/// tension positive, in VTK's order).
pub fn blocks<R: Real>(scene: &Scene, begin: &State<R>, state: &State<R>) -> UnstructuredGrid {
    let mut grid = UnstructuredGrid { time: state.time.to_f64(), ..UnstructuredGrid::default() };
    let mut polyhedra = Polyhedra::default();
    let (mut displacement, mut velocity) = (Vec::new(), Vec::new());
    let (mut volume, mut drift, mut spin, mut stress) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for ((block, then), now) in scene.blocks.iter().zip(&begin.blocks).zip(&state.blocks) {
        let topology = block.block.topology();
        let points: Vec<Point> = now.vertices.iter().map(|v| point(*v)).collect();
        let (size, centroid) = volume_and_centroid(topology, &points);
        let rates = now.velocity.map(R::to_f64);
        for (at, before) in points.iter().zip(&then.vertices) {
            displacement.extend(minus(*at, point(*before)));
            velocity.extend(rate(&rates, minus(*at, centroid)));
        }
        volume.push(size);
        drift.extend_from_slice(&rates[..3]);
        spin.extend_from_slice(&rates[3..6]);
        stress.extend(VTK_ORDER.map(|k| now.stress[k].to_f64()));
        polyhedra.push(grid.points.len(), points.len(), topology.faces());
        grid.points.extend(points);
    }
    let unknowns = scene.blocks.iter().map(|block| block.body.motion.unknowns() as i64).collect();
    grid.point_data =
        vec![DataArray::floats("displacement", VECTOR, displacement), DataArray::floats("velocity", VECTOR, velocity)];
    grid.cell_data = vec![
        DataArray::integers("block", SCALAR, (0..scene.blocks.len() as i64).collect()),
        DataArray::integers("unknowns", SCALAR, unknowns),
        DataArray::floats("volume", SCALAR, volume),
        DataArray::floats("centroid_velocity", VECTOR, drift),
        DataArray::floats("spin", VECTOR, spin),
        DataArray::floats("stress", TENSOR, stress),
    ];
    grid.cells = Cells::Polyhedra(polyhedra);
    grid
}

/// The blocks of a scene where it has them, with data of each block.
pub fn model(scene: &Scene, cell_data: Vec<DataArray>) -> UnstructuredGrid {
    let mut grid = UnstructuredGrid { cell_data, ..UnstructuredGrid::default() };
    let mut polyhedra = Polyhedra::default();
    for block in scene.shapes() {
        let points = block.vertices().iter().map(|v| v.components().map(|c| c.approximate()));
        polyhedra.push(grid.points.len(), block.vertices().len(), block.topology().faces());
        grid.points.extend(points);
    }
    grid.cells = Cells::Polyhedra(polyhedra);
    grid
}

/// The contacts of the last step as points, where they act on A. Data: blocks, kind (0 v-v, 1 v-e, 2 e-v, 3 v-f, 4 f-v,
/// 5 e-e), mode (0 open, 1 sliding, 2 locked), gap (m, negative overlaps), normal (from B to A), force (N, of B on A).
pub fn contacts<R: Real>(state: &State<R>) -> UnstructuredGrid {
    let all = &state.contacts;
    let vectors = |of: &dyn Fn(&ContactState<R>) -> Vector<R>| all.iter().flat_map(|c| point(of(c))).collect();
    let integers = |of: &dyn Fn(&ContactState<R>) -> i64| all.iter().map(of).collect();
    UnstructuredGrid {
        time: state.time.to_f64(),
        points: all.iter().map(|c| point(c.points[0])).collect(),
        cells: Cells::Vertices,
        point_data: vec![
            DataArray::integers("blocks", BLOCKS, all.iter().flat_map(|c| c.blocks.map(i64::from)).collect()),
            DataArray::integers("kind", SCALAR, integers(&|c| c.contact.kind() as i64)),
            DataArray::integers("mode", SCALAR, integers(&|c| c.mode as i64)),
            DataArray::floats("gap", SCALAR, all.iter().map(|c| c.gap.to_f64()).collect()),
            DataArray::floats("normal", VECTOR, vectors(&|c| c.normal)),
            DataArray::floats("force", VECTOR, vectors(&|c| c.force)),
        ],
        cell_data: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::{Block, Number, Vec3};

    #[test]
    fn a_turned_box_has_its_volume_and_centroid() {
        let corner = |x: i32, y: i32, z: i32| {
            Vec3::new(Number::from_integer(x), Number::from_integer(y), Number::from_integer(z))
        };
        let block = Block::cuboid(&corner(1, 2, 3), &corner(3, 5, 7)).expect("a box");
        let turned: Vec<Point> = block
            .vertices()
            .iter()
            .map(|v| v.components().map(Number::approximate))
            .map(|[x, y, z]| [0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y, z])
            .collect();
        let (volume, centroid) = volume_and_centroid(block.topology(), &turned);
        assert!((volume - 24.0).abs() < 1e-12);
        let expected = [0.6 * 2.0 - 0.8 * 3.5, 0.8 * 2.0 + 0.6 * 3.5, 5.0];
        assert!(minus(centroid, expected).iter().all(|d| d.abs() < 1e-12), "{centroid:?}");
    }

    #[test]
    fn the_rate_is_that_of_the_displacement_matrix() {
        // One unknown at a time against the columns of T in SPEC section 5, at X = (2, 3, 5).
        let columns: [Point; 12] = [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, -5.0, 3.0],
            [5.0, 0.0, -2.0],
            [-3.0, 2.0, 0.0],
            [2.0, 0.0, 0.0],
            [0.0, 3.0, 0.0],
            [0.0, 0.0, 5.0],
            [0.0, 2.5, 1.5],
            [2.5, 0.0, 1.0],
            [1.5, 1.0, 0.0],
        ];
        for (k, column) in columns.iter().enumerate() {
            let unit = std::array::from_fn(|m| if m == k { 1.0 } else { 0.0 });
            assert_eq!(rate(&unit, [2.0, 3.0, 5.0]), *column, "unknown {k}");
        }
    }
}
