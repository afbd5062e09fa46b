(** Extraction of the checker to OCaml: [Z], [N] and [positive] become Zarith integers (Coq's own mapping), booleans,
    options, pairs and lists OCaml's; [nat] stays unary. *)
From Coq Require Import Extraction ExtrOcamlBasic ExtrOcamlZBigInt ZArith.
From Ratt Require Import Dyadic Graph Scores Covers Lemmas Gains UpperTree LowerTree CaseTree Costs GroupProofs Sizes Checker.

(** Only hints are computed with these two: every use is checked, or right for any number. *)
Extract Constant Z.sqrt => "Big_int_Z.(fun x -> if sign_big_int x < 0 then zero_big_int else sqrt_big_int x)".
Extract Constant Z.log2 => "Big_int_Z.(fun x -> if sign_big_int x <= 0 then zero_big_int else big_int_of_int (Z.numbits x - 1))".
Extraction Language OCaml.
Extraction "checker.ml" check seeing_groups attack_ok.
