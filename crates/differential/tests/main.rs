//! Engines as programs, and answers about bent faces, in one program.

mod bent_faces;
mod external_answers;
