//! Plain words for every term a report uses.

/// Terms and what they mean, in an order in which each builds on those before.
pub const GLOSSARY: [(&str, &str); 40] = [
    ("block", "A solid with flat faces: a piece of rock, a stone of a wall."),
    ("pair", "Two blocks, A and B, near enough that they might touch."),
    ("contact", "A place where two blocks touch or nearly do, named by the two features that meet there."),
    (
        "kind",
        "Which features meet: v-v two corners, v-e a corner of A and an edge of B, e-v an edge of A and a corner of B, v-f a corner of A and a face of B, f-v a face of A and a corner of B, e-e two edges that cross.",
    ),
    (
        "entrance",
        "The plane through which the blocks would enter one another at a contact. Pushing them apart along its normal must undo the overlap; with another entrance they are pushed another way.",
    ),
    (
        "gap",
        "How far apart the blocks are through the entrance of a contact, in metres. Negative: they overlap by so much.",
    ),
    (
        "penetration",
        "How deep two blocks overlap. As a tolerance: the deepest overlap that is still taken for a contact.",
    ),
    (
        "oracle",
        "The exact side of Rockproof. It decides every question about the given numbers without any rounding, so its answer is the right one.",
    ),
    ("engine", "A program under examination: stepper-f32 and stepper-f64 are built in, others can be connected."),
    ("stepper", "The built-in engine. It calculates as a production code does, in f32 or f64."),
    ("f32, f64", "Single and double precision: numbers of about 7 and about 16 decimal digits."),
    ("rounding", "What happens when a number does not fit into f32 or f64: it becomes the nearest one that does."),
    ("roundoff", "The largest relative error of one rounding: 6·10⁻⁸ in f32, 1.1·10⁻¹⁶ in f64."),
    (
        "tolerance set",
        "The small lengths and angles that decide what counts as touching, as parallel, as overlapping. auto, shi and zero are presets; those called dyadic consist of numbers with few binary digits.",
    ),
    (
        "setting",
        "A tolerance set in a report. \"auto (ladders)\" are all sets made from auto by moving one tolerance onto the edge of a decision: they are as hard as can be, on purpose.",
    ),
    ("search", "Tolerance: the largest gap at which a contact is recorded."),
    (
        "territory",
        "Tolerance: the size of the zones around corners and edges. What is in a corner's zone belongs to the corner, not to the faces beside it.",
    ),
    ("overlap angle", "Tolerance: by how much a corner may dip below a face and still pass as lying on it."),
    ("parallel angle", "Tolerance: edges closer to parallel than this do not count as crossing."),
    ("equal (ε)", "Tolerance: gaps that differ by less than this share count as equal."),
    (
        "criteria",
        "Which rules are used: classic has the customary ones, revised those that take account of the size of each feature.",
    ),
    (
        "family",
        "A recipe for pairs: corners against corners, slivers, blocks far from the origin, neighbours of a real file and so on. Most are put on the very edge of a decision, so agreement on them is much lower than in an ordinary model.",
    ),
    ("campaign", "Many pairs, each classified exactly and by every engine, and compared."),
    (
        "agreement",
        "The share of pairs for which two answers are the same in everything: contacts, kinds, features, entrances, signs of gaps.",
    ),
    (
        "95 % interval",
        "Where the true share lies, with 95 % confidence, if many more such pairs were made (Wilson's interval). Pairs made from the same blocks differ together and count for fewer.",
    ),
    (
        "confusion matrix",
        "Rows: the kind a contact truly is. Columns: the kind the engine saw. Off the diagonal is what went wrong; none means that there is no such contact.",
    ),
    ("finding", "One change in the contacts of one pair."),
    (
        "cause: tolerance",
        "The contacts change when the tolerances are applied, everything calculated exactly. Help: other tolerances.",
    ),
    (
        "cause: representation",
        "The contacts change when the input is rounded to the engine's format. Help: a model near the origin, f64, or wider tolerances.",
    ),
    (
        "cause: arithmetic",
        "The contacts change because the engine calculates in its precision. The price of floating point; a margin far above one roundoff means a formula that could be better.",
    ),
    (
        "cause: defect",
        "The contacts are wrong even when the engine calculates with several hundred bits: a mistake in the code.",
    ),
    (
        "cause: engine",
        "An external engine answers otherwise; its arithmetic or its code, which cannot be told apart from outside.",
    ),
    ("predicate", "One question on the way to an answer, such as: is this corner above that face?"),
    (
        "margin",
        "How clearly a predicate was decided: its exact value over the sum of the sizes of its terms. 0 is a tie, 1 as clear as can be.",
    ),
    ("tie", "A predicate that is exactly 0. It still has one right answer."),
    ("lockstep", "A run in which the oracle makes every step beside the stepper, from the same state."),
    (
        "iteration",
        "One solve of a step's open–close iteration, which finds out which contacts are open, sliding or locked.",
    ),
    ("mode", "Whether a contact is open, sliding or locked."),
    (
        "case",
        "A finding in a file of its own, made as small as possible; rockproof replay shows it decision by decision.",
    ),
    ("efficient", "Nothing else measured on the same case is both faster and less wrong."),
];
