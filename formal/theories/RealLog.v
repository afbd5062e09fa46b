(** The natural logarithm of Coq's real numbers has the two properties of [Logdet.logarithm]. Coq's real numbers rest on
    the axioms of its standard library, so this file is beside the headline theorems: none of them uses it. *)
From Coq Require Import Reals Lra.
Local Open Scope R_scope.

Theorem real_ln_product (x y : R) : 0 < x -> 0 < y -> ln (x * y) = ln x + ln y.
Proof. exact (ln_mult x y). Qed.

Theorem real_ln_tangent (x : R) : 0 < x -> ln x <= x - 1.
Proof.
intros x0; pose proof (exp_ineq1_le (ln x)) as h; rewrite exp_ln in h by assumption; lra.
Qed.
