(** Teams, plans, attacks, groups, worst case and optimum: the paper's definitions. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

(** ** A team and its adversary *)
Section Definitions.
Variables (F : realDomainType) (R E : finType).

(** Every element (a control of a robot) has an owner. A link is a set of two robots; the graph is any set of links.
    The adversary blinds at most [alpha_s] robots and cuts at most [alpha_c] links, none of them protected. *)
Record team := Team {
  owner : E -> R;
  links : {set {set R}};
  alpha_s : nat;
  alpha_c : nat;
  safe_robots : {set R};
  safe_links : {set {set R}}
}.

(** A plan picks one element for each robot, one of its own. *)
Definition is_plan (t : team) (p : {ffun R -> E}) : bool := [forall i, owner t (p i) == i].

(** What an attack blinds and what it cuts. *)
Definition attack : Type := ({set R} * {set {set R}})%type.
Definition blinded (a : attack) : {set R} := a.1.
Definition cut (a : attack) : {set {set R}} := a.2.

Definition allowed (t : team) (a : attack) : bool :=
  [&& #|blinded a| <= alpha_s t, #|cut a| <= alpha_c t, cut a \subset links t,
      [disjoint blinded a & safe_robots t] & [disjoint cut a & safe_links t]]%N.

(** Links that are left, and groups: the connected components of what is left. A blinded robot relays, so it is in a
    group; [sees] is the part of the group of robot [i] that still sees. *)
Definition linked (t : team) (a : attack) : rel R :=
  fun i j => (i != j) && ([set i; j] \in links t :\: cut a).
Definition group (t : team) (a : attack) (i : R) : {set R} := [set j | connect (linked t a) i j].
Definition sees (t : team) (a : attack) (i : R) : {set R} := group t a i :\: blinded a.

(** The elements that the robots of a set contribute. *)
Definition contributed (p : {ffun R -> E}) (G : {set R}) : {set E} := p @: G.

(** Value of the best group (of the empty set if there is no robot at all). *)
Definition team_value (t : team) (phi : {set E} -> F) (p : {ffun R -> E}) (a : attack) : F :=
  let value i := phi (contributed p (sees t a i)) in
  if [pick i : R] is Some i0 then \big[Num.max/value i0]_(i <- enum R) value i else phi set0.

Definition no_attack : attack := (set0, set0).

(** The worst case of a plan: the least team value over all attacks within the budgets. *)
Definition worst_case (t : team) (phi : {set E} -> F) (p : {ffun R -> E}) : F :=
  \big[Num.min/team_value t phi p no_attack]_(a <- enum [finType of attack] | allowed t a) team_value t phi p a.

(** [x] is the optimum: the greatest worst case of a plan. *)
Definition is_optimum (t : team) (phi : {set E} -> F) (x : F) : Prop :=
  (exists2 p, is_plan t p & worst_case t phi p = x) /\ (forall p, is_plan t p -> worst_case t phi p <= x).

(** The optimum as a number; [0] if there is no plan. *)
Definition optimum (t : team) (phi : {set E} -> F) : F :=
  if [pick p : {ffun R -> E} | is_plan t p] is Some p0 then
    \big[Num.max/worst_case t phi p0]_(p <- enum [finType of {ffun R -> E}] | is_plan t p) worst_case t phi p
  else 0.
End Definitions.

(** ** What follows at once *)
Section Facts.
Variables (F : realDomainType) (R E : finType) (t : team R E) (phi : {set E} -> F).
Implicit Types (p : {ffun R -> E}) (a : attack R) (x : F).

Lemma linked_sym a : symmetric (linked t a).
Proof. by move=> i j; rewrite /linked eq_sym setUC. Qed.

Lemma connect_linked_sym a : connect_sym (linked t a).
Proof. exact/sym_connect_sym/linked_sym. Qed.

Lemma mem_sees a i : i \notin blinded a -> i \in sees t a i.
Proof. by move=> h; rewrite !inE h connect0. Qed.

Lemma le_team_value p a i : phi (contributed p (sees t a i)) <= team_value t phi p a.
Proof.
rewrite /team_value; case: pickP => [i0 _|/(_ i)//].
by apply: (@le_bigmax F _ (enum R) xpredT (fun i => phi (contributed p (sees t a i)))); rewrite ?mem_enum.
Qed.

Lemma team_value_attained p a : R -> exists i, team_value t phi p a = phi (contributed p (sees t a i)).
Proof.
move=> i1; rewrite /team_value; case: pickP => [i0 _|/(_ i1)//].
case: (@bigmax_attained F _ (enum R) xpredT (fun i => phi (contributed p (sees t a i)))
  (phi (contributed p (sees t a i0)))) => [->|[i [_ _ ->]]]; first by exists i0.
by exists i.
Qed.

Lemma team_value_le p a x : R -> (forall i, phi (contributed p (sees t a i)) <= x) -> team_value t phi p a <= x.
Proof. by move=> i1 h; have [i ->] := team_value_attained p a i1. Qed.

Lemma no_attack_allowed : allowed t (no_attack R).
Proof. by rewrite /allowed /= !cards0 sub0set !leq0n /=; apply/andP; split; apply/pred0P => z; rewrite /= in_set0. Qed.

Lemma worst_case_le p a : allowed t a -> worst_case t phi p <= team_value t phi p a.
Proof. by move=> ok; apply: (@bigmin_le _ _ _ (allowed t) (team_value t phi p)); rewrite ?mem_enum. Qed.

Lemma worst_case_attained p : exists2 a, allowed t a & worst_case t phi p = team_value t phi p a.
Proof.
rewrite /worst_case; case: (bigmin_attained (enum [finType of attack R]) (allowed t) (team_value t phi p)
  (team_value t phi p (no_attack R))) => [->|[a [_ ok ->]]]; last by exists a.
by exists (no_attack R); rewrite ?no_attack_allowed.
Qed.

Lemma le_worst_case p x : (forall a, allowed t a -> x <= team_value t phi p a) -> x <= worst_case t phi p.
Proof. by move=> h; have [a ok ->] := worst_case_attained p; apply: h. Qed.

Lemma le_worst_caseP p x : x <= worst_case t phi p <-> (forall a, allowed t a -> x <= team_value t phi p a).
Proof.
split=> [h a ok|]; last exact: le_worst_case.
exact: le_trans h (worst_case_le p ok).
Qed.

Lemma worst_case_leP p x : worst_case t phi p <= x <-> (exists2 a, allowed t a & team_value t phi p a <= x).
Proof.
split=> [h|[a ok h]]; last exact: le_trans (worst_case_le p ok) h.
by have [a ok eq] := worst_case_attained p; exists a; rewrite -?eq.
Qed.

Lemma optimumP p : is_plan t p -> is_optimum t phi (optimum t phi).
Proof.
move=> okp; rewrite /optimum; case: pickP => [p0 ok0|/(_ p)]; last by rewrite okp.
split; last by move=> q okq; apply: le_bigmax; rewrite ?mem_enum.
case: (bigmax_attained (enum [finType of {ffun R -> E}]) (is_plan t) (worst_case t phi) (worst_case t phi p0))
  => [->|[q [_ okq ->]]]; first by exists p0.
by exists q.
Qed.

Lemma plan_owner p i : is_plan t p -> owner t (p i) = i.
Proof. by move/forallP => /(_ i)/eqP. Qed.

Lemma plan_inj p : is_plan t p -> injective p.
Proof. by move=> okp i j eq; rewrite -(plan_owner i okp) eq (plan_owner j okp). Qed.
End Facts.

(** A plan that keeps, in every set of robots, the share [s] of what any other plan has there keeps the share [s] of
    the optimum after the worst attack: the reason why neither the budgets nor the graph matter. *)
Section Share.
Variables (F : realDomainType) (R E : finType) (t : team R E) (phi : {set E} -> F).

Lemma share_of_worst_case (s : F) (u o : {ffun R -> E}) : R -> 0 <= s ->
  (forall S : {set R}, s * phi (contributed o S) <= phi (contributed u S)) ->
  s * worst_case t phi o <= worst_case t phi u.
Proof.
move=> i0 s0 h; apply: le_worst_case => a ok.
apply: le_trans (_ : s * team_value t phi o a <= _).
  by apply: ler_wpmul2l => //; apply: worst_case_le.
have [i ->] := team_value_attained t phi o a i0.
exact: le_trans (h _) (le_team_value t phi u a i).
Qed.
End Share.
