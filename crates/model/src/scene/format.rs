//! Which formats there are: the one list that readers, writers, messages and options go by.

use crate::block::Merging;
use crate::files::without_mark;
use crate::scene::stl;
use std::ffi::OsStr;
use std::path::Path;

/// A file format for blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SceneFormat {
    /// The project's own scenes, `.toml`.
    Toml,
    /// UnBlocks-gen, `.dda`.
    Dda,
    /// Wavefront, `.obj`.
    Obj,
    /// Stereolithography, text or binary, `.stl`.
    Stl,
    /// Polygons (Stanford), text or binary, `.ply`.
    Ply,
    /// Gmsh, in ASCII or binary, `.msh`.
    Msh,
    /// Legacy VTK in ASCII, unstructured grids, `.vtk`.
    Vtk,
    /// VTK's unstructured grids in XML, `.vtu`.
    Vtu,
    /// voro++, `.txt` or `.voro`.
    Voro,
}

impl SceneFormat {
    /// Whether coordinates of a file of this format with these bytes are f32: those of a binary STL, and of a PLY with `float x`.
    pub fn holds_f32(self, bytes: &[u8]) -> bool {
        match self {
            SceneFormat::Stl => !stl::is_text(without_mark(bytes)),
            SceneFormat::Ply => {
                let lines = bytes.split(|&byte| byte == b'\n' || byte == b'\r').map(<[u8]>::trim_ascii);
                lines.take_while(|line| *line != b"end_header").any(|line| {
                    let words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
                    matches!(words.collect::<Vec<_>>()[..], [b"property", b"float" | b"float32", b"x"])
                })
            }
            _ => false,
        }
    }

    /// All formats, in the order in which messages name them.
    pub const ALL: [SceneFormat; 9] = [
        SceneFormat::Toml,
        SceneFormat::Dda,
        SceneFormat::Obj,
        SceneFormat::Stl,
        SceneFormat::Ply,
        SceneFormat::Msh,
        SceneFormat::Vtk,
        SceneFormat::Vtu,
        SceneFormat::Voro,
    ];

    /// How names of such files end, in small letters, without the dot.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            SceneFormat::Toml => &["toml"],
            SceneFormat::Dda => &["dda"],
            SceneFormat::Obj => &["obj"],
            SceneFormat::Stl => &["stl"],
            SceneFormat::Ply => &["ply"],
            SceneFormat::Msh => &["msh"],
            SceneFormat::Vtk => &["vtk"],
            SceneFormat::Vtu => &["vtu"],
            SceneFormat::Voro => &["txt", "voro"],
        }
    }

    /// What the format is called where there is no file name: its extension, but for voro++.
    pub fn name(self) -> &'static str {
        if self == SceneFormat::Voro { "voro" } else { self.extensions()[0] }
    }

    /// The format of a name.
    pub fn from_name(name: &str) -> Option<SceneFormat> {
        SceneFormat::ALL.into_iter().find(|format| format.name() == name)
    }

    /// The format that the bytes of a file show, by what such files begin with; none where they begin as no format does. That the
    /// rest is of this format is not said.
    pub fn of_contents(bytes: &[u8]) -> Option<SceneFormat> {
        if stl::is_binary(bytes) {
            return Some(SceneFormat::Stl);
        }
        let begun = without_mark(bytes).trim_ascii_start();
        let marks: [(&[u8], SceneFormat); 7] = [
            (b"#_DDA_DataFile", SceneFormat::Dda),
            (b"# vtk DataFile", SceneFormat::Vtk),
            (b"$MeshFormat", SceneFormat::Msh),
            (b"ply\n", SceneFormat::Ply),
            (b"ply\r", SceneFormat::Ply),
            (b"<?xml", SceneFormat::Vtu),
            (b"<VTKFile", SceneFormat::Vtu),
        ];
        if let Some((_, format)) = marks.into_iter().find(|(mark, _)| begun.starts_with(mark)) {
            return Some(format);
        }
        // Comments begin alike in TOML and OBJ, so the first line that is none tells; voro++ has no comments.
        let lines = begun.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
        let line = lines.into_iter().find(|line| !line.is_empty() && !line.starts_with(b"#"))?;
        let word = line.split(u8::is_ascii_whitespace).next().unwrap_or_default();
        match word {
            b"v" | b"vt" | b"vn" | b"vp" | b"f" | b"l" | b"p" | b"o" | b"g" | b"s" | b"usemtl" | b"mtllib"
                if word != line =>
            {
                // `s = 1` is TOML.
                let rest = line[word.len()..].trim_ascii_start();
                Some(if rest.starts_with(b"=") { SceneFormat::Toml } else { SceneFormat::Obj })
            }
            _ if word.eq_ignore_ascii_case(b"solid") => Some(SceneFormat::Stl),
            _ if line.starts_with(b"[") || line.contains(&b'=') => Some(SceneFormat::Toml),
            _ if word.iter().all(u8::is_ascii_digit) && line.contains(&b'(') => Some(SceneFormat::Voro),
            _ => None,
        }
    }

    /// The format that a file's extension names; upper or lower case.
    pub fn of_path(path: &Path) -> Option<SceneFormat> {
        let extension = path.extension().and_then(OsStr::to_str)?.to_ascii_lowercase();
        SceneFormat::ALL.into_iter().find(|format| format.extensions().contains(&extension.as_str()))
    }

    /// Whether [`super::write()`] writes it; all formats are read.
    pub fn is_written(self) -> bool {
        match self {
            SceneFormat::Toml | SceneFormat::Obj | SceneFormat::Stl | SceneFormat::Ply => true,
            SceneFormat::Msh | SceneFormat::Vtk | SceneFormat::Vtu => true,
            SceneFormat::Dda | SceneFormat::Voro => false,
        }
    }

    /// Whether such files hold meshes, often of triangles whose coordinates were rounded: faces that one plane holds within the planarity
    /// become one. The other formats hold faces as they are.
    pub fn is_mesh(self) -> bool {
        !matches!(self, SceneFormat::Toml | SceneFormat::Dda | SceneFormat::Voro)
    }

    pub(super) fn merging(self) -> Merging {
        if self.is_mesh() { Merging::WithinPlanarity } else { Merging::Exact }
    }

    /// The extensions of some formats for a message: ".toml, .obj and .vtk".
    pub fn listed(which: impl Fn(SceneFormat) -> bool) -> String {
        let formats = SceneFormat::ALL.into_iter().filter(|format| which(*format));
        let names: Vec<String> = formats.flat_map(SceneFormat::extensions).map(|name| format!(".{name}")).collect();
        match names.split_last() {
            Some((last, [])) => last.clone(),
            Some((last, others)) => format!("{} and {last}", others.join(", ")),
            None => String::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_f32_are_told_as_readers_tell_them() {
        let binary = [&b"solid but binary"[..], &[0; 68]].concat();
        let text = b"solid a\nendsolid a\n";
        let ply = |kind: &str| {
            format!("ply\nformat ascii 1.0\nelement vertex 0\nproperty {kind} x\nend_header\n").into_bytes()
        };
        for (format, bytes, holds) in [
            (SceneFormat::Stl, binary, true),
            (SceneFormat::Stl, text.to_vec(), false),
            (SceneFormat::Stl, [&b"\xef\xbb\xbf"[..], text].concat(), false),
            (SceneFormat::Ply, ply("float"), true),
            (SceneFormat::Ply, ply("float32"), true),
            (SceneFormat::Ply, ply("double"), false),
            (SceneFormat::Obj, ply("float"), false),
        ] {
            assert_eq!(format.holds_f32(&bytes), holds, "{format:?}: {}", String::from_utf8_lossy(&bytes));
        }
    }
}
