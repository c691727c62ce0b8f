//! VTK's XML files, as ParaView reads them: unstructured grids (`.vtu`) and lists of them over time (`.pvd`).
//!
//! Numbers are inline base64 with a length of eight bytes before them, so that every bit arrives; VTK's reader of decimals
//! gives up at subnormal numbers. Polyhedra are face streams (`faces`, `faceoffsets`), which all versions read.

use crate::topology::VertexId;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};
use std::io;

/// Points, cells on them, and data on both.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnstructuredGrid {
    /// The time it shows (s).
    pub time: f64,
    /// Where the points are (m).
    pub points: Vec<[f64; 3]>,
    /// The cells.
    pub cells: Cells,
    /// Data on the points.
    pub point_data: Vec<DataArray>,
    /// Data on the cells.
    pub cell_data: Vec<DataArray>,
}

/// The cells of a grid, all of one kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Cells {
    /// One cell on each point.
    Vertices,
    /// Polyhedra.
    Polyhedra(Polyhedra),
}

impl Default for Cells {
    /// A cell on each point.
    fn default() -> Cells {
        Cells::Vertices
    }
}

/// Polyhedra in VTK's layout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyhedra {
    /// The points of each cell, cell after cell.
    connectivity: Vec<i64>,
    /// Where each cell ends in `connectivity`.
    offsets: Vec<i64>,
    /// For each cell: number of faces, then for each face number of points and points.
    faces: Vec<i64>,
    /// Where each cell ends in `faces`.
    face_offsets: Vec<i64>,
}

impl Polyhedra {
    /// Adds a cell on `count` points from number `first`; its faces number them from 0.
    pub fn push(&mut self, first: usize, count: usize, faces: &[Vec<VertexId>]) {
        self.connectivity.extend((first..first + count).map(|point| point as i64));
        self.offsets.push(self.connectivity.len() as i64);
        self.faces.push(faces.len() as i64);
        for face in faces {
            self.faces.push(face.len() as i64);
            self.faces.extend(face.iter().map(|&vertex| first as i64 + i64::from(vertex.0)));
        }
        self.face_offsets.push(self.faces.len() as i64);
    }
}

/// A named array of data, of one or more components each.
#[derive(Clone, Debug, PartialEq)]
pub struct DataArray {
    /// Its name.
    pub name: &'static str,
    /// The names of the components; one without a name for a scalar.
    pub components: &'static [&'static str],
    /// The values, all components of one place together.
    pub values: Values,
}

/// The values of an array.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers.
    Float(Vec<f64>),
    /// Integers.
    Integer(Vec<i64>),
}

/// Components of a scalar.
pub const SCALAR: &[&str] = &[""];
/// Components of a vector.
pub const VECTOR: &[&str] = &["X", "Y", "Z"];

impl DataArray {
    /// An array of numbers.
    pub fn floats(name: &'static str, components: &'static [&'static str], values: Vec<f64>) -> DataArray {
        DataArray { name, components, values: Values::Float(values) }
    }

    /// An array of integers.
    pub fn integers(name: &'static str, components: &'static [&'static str], values: Vec<i64>) -> DataArray {
        DataArray { name, components, values: Values::Integer(values) }
    }
}

impl Values {
    fn type_name(&self) -> &'static str {
        match self {
            Values::Float(_) => "Float64",
            Values::Integer(_) => "Int64",
        }
    }

    fn bytes(&self) -> Vec<u8> {
        match self {
            Values::Float(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            Values::Integer(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        }
    }
}

type Xml = Writer<Vec<u8>>;

/// A file that VTK reads.
fn file(kind: &str, content: impl FnOnce(&mut Xml) -> io::Result<()>) -> io::Result<Vec<u8>> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 1);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let attributes = [("type", kind), ("version", "1.0"), ("byte_order", "LittleEndian"), ("header_type", "UInt64")];
    xml.create_element("VTKFile").with_attributes(attributes).write_inner_content(content)?;
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

/// One `DataArray`, with attributes beside those every one has.
fn data_array(xml: &mut Xml, kind: &str, more: &[(String, String)], bytes: &[u8]) -> io::Result<()> {
    let with_length = [&(bytes.len() as u64).to_le_bytes(), bytes].concat();
    let text = STANDARD.encode(with_length);
    let more = more.iter().map(|(key, value)| (key.as_str(), value.as_str()));
    xml.create_element("DataArray")
        .with_attribute(("type", kind))
        .with_attributes(more)
        .with_attribute(("format", "binary"))
        .write_text_content(BytesText::new(&text))?;
    Ok(())
}

fn attribute(key: impl Into<String>, value: impl Into<String>) -> (String, String) {
    (key.into(), value.into())
}

fn array(xml: &mut Xml, array: &DataArray) -> io::Result<()> {
    let mut more = vec![attribute("Name", array.name)];
    if array.components.len() > 1 {
        more.push(attribute("NumberOfComponents", array.components.len().to_string()));
    }
    let named = array.components.iter().enumerate().filter(|(_, name)| !name.is_empty());
    more.extend(named.map(|(k, name)| attribute(format!("ComponentName{k}"), *name)));
    data_array(xml, array.values.type_name(), &more, &array.values.bytes())
}

fn arrays(xml: &mut Xml, element: &str, all: &[DataArray]) -> io::Result<()> {
    xml.create_element(element).write_inner_content(|xml| all.iter().try_for_each(|one| array(xml, one)))?;
    Ok(())
}

/// VTK's numbers of its kinds of cells.
const VTK_VERTEX: u8 = 1;
const VTK_POLYHEDRON: u8 = 42;

/// The grid as the bytes of a `.vtu` file.
///
/// # Errors
/// None that writing to memory has.
pub fn vtu(grid: &UnstructuredGrid) -> io::Result<Vec<u8>> {
    let count = grid.points.len();
    let vertices = || (0..count as i64).collect::<Vec<_>>();
    let (connectivity, offsets, kind, faces) = match &grid.cells {
        Cells::Vertices => (vertices(), (1..=count as i64).collect(), VTK_VERTEX, None),
        Cells::Polyhedra(all) => {
            let Polyhedra { connectivity, offsets, faces, face_offsets } = all.clone();
            (connectivity, offsets, VTK_POLYHEDRON, Some((faces, face_offsets)))
        }
    };
    let cells = offsets.len();
    let piece = [("NumberOfPoints", count.to_string()), ("NumberOfCells", cells.to_string())];
    file("UnstructuredGrid", |xml| {
        xml.create_element("UnstructuredGrid").write_inner_content(|xml| {
            xml.create_element("FieldData").write_inner_content(|xml| {
                let more = [attribute("Name", "TimeValue"), attribute("NumberOfTuples", "1")];
                data_array(xml, "Float64", &more, &grid.time.to_le_bytes())
            })?;
            let piece = piece.iter().map(|(key, value)| (*key, value.as_str()));
            xml.create_element("Piece").with_attributes(piece).write_inner_content(|xml| {
                arrays(xml, "PointData", &grid.point_data)?;
                arrays(xml, "CellData", &grid.cell_data)?;
                let points = grid.points.iter().flatten().copied().collect();
                arrays(xml, "Points", &[DataArray::floats("Points", VECTOR, points)])?;
                xml.create_element("Cells").write_inner_content(|xml| {
                    array(xml, &DataArray::integers("connectivity", SCALAR, connectivity))?;
                    array(xml, &DataArray::integers("offsets", SCALAR, offsets))?;
                    data_array(xml, "UInt8", &[attribute("Name", "types")], &vec![kind; cells])?;
                    if let Some((faces, face_offsets)) = faces {
                        array(xml, &DataArray::integers("faces", SCALAR, faces))?;
                        array(xml, &DataArray::integers("faceoffsets", SCALAR, face_offsets))?;
                    }
                    Ok(())
                })?;
                Ok(())
            })?;
            Ok(())
        })?;
        Ok(())
    })
}

/// A `.pvd` file: which file shows which time.
///
/// # Errors
/// None that writing to memory has.
pub fn pvd(files: &[(f64, String)]) -> io::Result<Vec<u8>> {
    file("Collection", |xml| {
        xml.create_element("Collection").write_inner_content(|xml| {
            for (time, file) in files {
                let time = format!("{time:?}");
                let attributes = [("timestep", time.as_str()), ("part", "0"), ("file", file.as_str())];
                xml.create_element("DataSet").with_attributes(attributes).write_empty()?;
            }
            Ok(())
        })?;
        Ok(())
    })
}
