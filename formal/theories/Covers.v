(** Covers: conditions that every plan worth more than a level meets.

    Cut some links and leave some elements out. If a plan chooses left-out elements at robots that can be blinded all at
    once, an attack leaves kept ones alone, and a tangent for each group says that these are worth no more than a level.
    A protected robot cannot be blinded, so its elements count as often as it takes. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema Teams Dyadic DyadicMatrix Graph Scores.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** A constant and a score for each element: with the scores of what a group chose it is at least the group's value. *)
Definition tangent := (seq dyadic * dyadic)%type.

(** Whether an element is left out, and what the kept ones are worth at most, group by group. *)
Record cover_bound := CoverBound { left_out : seq bool; levels : seq dyadic }.

Definition marks (c : cover_bound) : seq dyadic := [seq if out then d1 else d0 | out <- left_out c].
Definition kept (out : seq bool) (s : seq dyadic) : seq dyadic := [seq if x.1 then d0 else x.2 | x <- zip out s].

Section Checker.
Variables (w : network) (covers : seq cover_bound) (upper : dyadic).

(** A blinded robot adds 0: so does a robot whose kept elements all score less. *)
Definition group_level (choices : seq (seq nat)) (out : seq bool) (g : seq nat) (t : tangent) : dyadic :=
  let s := kept out t.1 in
  dadd t.2 (dsum [seq dmax d0 (largest_of (nth d0 s) (nth [::] choices i)) | i <- [seq i <- iota 0 (robots w) | i \in g]]).
Definition cover_levels (out : seq bool) (groups : seq (seq nat)) (ts : seq tangent) : seq dyadic :=
  let choices := all_plans w in [seq group_level choices out x.1 x.2 | x <- zip groups ts].

(** What a plan needs of left-out elements to meet a cover, and how often a robot's element counts. *)
Definition needed : nat := (minn (blind_budget w) (count (fun i => i \notin kept_robots w) (iota 0 (robots w)))).+1.
Definition counted (i : nat) : nat := if i \in kept_robots w then needed else 1.

Definition cover_of (k : nat) : cover_bound := nth (CoverBound [::] [::]) covers k.
(** No plan of the case meets all the covers that are used: it counts less than their weights ask for together. *)
Definition check_cover_leaf (left : seq (seq nat)) (used : seq (nat * dyadic)) : bool :=
  let total := weighed (size (owners w)) (fun k => marks (cover_of k)) used in
  let most := dsum [seq dmul (dnat (counted i)) (largest_of (nth d0 total) (nth [::] left i)) | i <- iota 0 (robots w)] in
  all (fun kw => [&& (kw.1 < size covers)%N, dlt d0 kw.2 & all (fun x => dle x upper) (levels (cover_of kw.1))]) used &&
  dlt most (dmul (dnat needed) (dsum [seq kw.2 | kw <- used])).

Local Open Scope ring_scope.

Variable F : realFieldType.
Local Notation val := (val F).
Local Notation robot := 'I_(top_robot w).+1.
Local Notation element := 'I_(top_element w).+1.
Variables (phi : {set element} -> F) (p : {ffun robot -> element}).

Definition fails (c : cover_bound) : bool := (\sum_(i : robot) counted i * nth false (left_out c) (p i) < needed)%N.

Lemma check_cover_leafP left used : (forall k, (k < size covers)%N -> size (left_out (cover_of k)) = size (owners w)) ->
  check_cover_leaf left used -> in_case p left ->
  exists2 k, (k < size covers)%N & all (fun x => dle x upper) (levels (cover_of k)) && fails (cover_of k).
Proof.
move=> sizes /andP[/allP good lt] inc.
have [/hasP[kw kwu fail]|/hasPn meets] := boolP (has (fun kw => fails (cover_of kw.1)) used).
  by have /and3P[kl _ lev] := good _ kwu; exists kw.1; rewrite ?lev.
have le x : x \in used -> (needed <= \sum_(i : robot) counted i * nth false (left_out (cover_of x.1)) (p i))%N.
  by move=> /meets; rewrite -leqNgt.
move: lt; rewrite (val_lt F) val_mul val_nat val_sum_iota val_sum big_map ltNge => /negP[].
apply: le_trans (_ : \sum_(i : robot) \sum_(x <- used) val x.2 * (counted i * nth false (left_out (cover_of x.1)) (p i))%:R <= _).
  rewrite exchange_big mulr_sumr big_seq [X in _ <= X]big_seq; apply: ler_sum => x xu.
  rewrite -mulr_sumr -natr_sum mulrC; apply: ler_wpmul2l; last by rewrite ler_nat le.
  by have /and3P[_ x0 _] := good _ xu; move: x0; rewrite (val_lt F) val0 => /ltW.
apply: ler_sum => i _; rewrite val_mul val_nat.
rewrite (eq_bigr (fun x => (counted i)%:R * (val x.2 * (nth false (left_out (cover_of x.1)) (p i))%:R))); last first.
  by move=> x _; rewrite natrM mulrCA.
rewrite -mulr_sumr; apply: ler_wpmul2l; first exact: ler0n.
apply: le_trans (largest_ofP F _ (inc i)); rewrite weighedP => [|x /good/and3P[kl _ _]]; last first.
  by rewrite size_map sizes ?mem_nth.
rewrite [X in X <= _]big_seq [X in _ <= X]big_seq; apply: ler_sum => x /good/and3P[kl x0 _].
rewrite /marks; case: (ltnP (p i) (size (left_out (cover_of x.1)))) => [il|ge]; last first.
  by rewrite !nth_default ?size_map // val0.
by rewrite (nth_map false) //; case: nth; rewrite ?val0 ?val1.
Qed.

(** ** What a cover says of the plans that fail it *)
Hypotheses (ok : network_ok w) (okp : is_plan (team_of w) p).
Variables (a : listed_attack) (out : seq bool) (ts : seq tangent).
Hypotheses (oka : attack_ok w a) (sees_all : a.1 = [::]) (out_size : size out = size (owners w)).
Hypothesis sizes_ok : size ts = size (seeing_groups w a).
Hypothesis tangents_ok : {in ts, forall t, size t.1 = size (owners w) /\
  forall G : {set robot}, phi (contributed p G) <= val t.2 + \sum_(i in G) val (nth d0 t.1 (p i))}.
Let levels_of := cover_levels out (seeing_groups w a) ts.

Theorem failed_coverP : fails (CoverBound out levels_of) -> all (fun x => dle x upper) levels_of ->
  worst_case (team_of w) phi p <= val upper.
Proof.
rewrite /fails /= => few /allP low; pose B := [set i : robot | nth false out (p i)].
have sumB : (\sum_(i : robot) counted i * nth false out (p i) = \sum_(i in B) counted i)%N.
  rewrite [RHS]big_mkcond; apply: eq_bigr => i _; rewrite inE; by case: nth; rewrite ?muln1 ?muln0.
rewrite sumB in few; have unsafe i : i \in B -> (i : nat) \notin kept_robots w.
  move=> iB; apply: contraTN few => ik; rewrite (bigD1 i) //= {1}/counted ik -leqNgt; exact: leq_addr.
have cardB : (#|B| <= blind_budget w)%N.
  move: few; rewrite (eq_bigr (fun=> 1%N)) => [|i /unsafe/negbTE ik]; last by rewrite /counted ik.
  by rewrite sum1_card ltnS leq_min => /andP[].
pose b := (B, links_of w a.2) : attack [finType of robot].
have okb : allowed (team_of w) b.
  have /and5P[_ h1 h2 _ h3] := attack_of_allowed ok oka; apply/and5P; split=> //.
  by rewrite disjoint_subset; apply/subsetP => i /unsafe; rewrite !inE.
apply: le_trans (worst_case_le phi p okb) _; apply: team_value_le => [|i]; first exact: ord0.
have none : blinded (attack_of w a) = set0 by apply/setP => k; rewrite !inE sees_all.
have whole : sees (team_of w) (attack_of w a) i = group (team_of w) b i by rewrite /sees none setD0.
have ne : sees (team_of w) (attack_of w a) i != set0.
  by apply/set0Pn; exists i; apply: mem_sees; rewrite none inE.
have [g gin] := seeing_groupsP ok oka ne; rewrite whole => eg.
pose k := index g (seeing_groups w a); pose t := nth ([::], d0) ts k.
have kl : (k < size (seeing_groups w a))%N by rewrite index_mem.
have [st bound] : size t.1 = size (owners w) /\ forall G : {set robot},
    phi (contributed p G) <= val t.2 + \sum_(i in G) val (nth d0 t.1 (p i)).
  by apply: tangents_ok; apply: mem_nth; rewrite sizes_ok.
have lin : group_level (all_plans w) out g t \in levels_of.
  by apply/mapP; exists (g, t) => //; apply/(nthP ([::], ([::], d0))); exists k; rewrite ?size_zip ?sizes_ok ?minnn ?nth_zip ?nth_index.
have := low _ lin; rewrite (val_le F) => {low lin}; apply: le_trans; apply: le_trans (bound _) _.
rewrite /group_level val_add ler_add2l val_sum big_map big_filter.
rewrite (_ : iota 0 (robots w) = index_iota 0 (robots w)); last by rewrite /index_iota subn0.
rewrite (big_mkord (fun i => i \in g) (fun i => val (dmax d0 (largest_of (nth d0 (kept out t.1)) (nth [::] (all_plans w) i))))).
rewrite /sees eg /= [X in _ <= X]big_mkcond [X in X <= _]big_mkcond; apply: ler_sum => j _; rewrite val_max val0 !inE.
case jg: ((j : nat) \in g); last by rewrite andbF.
case jB: (nth false out (p j)) => /=; first by rewrite le_maxr lexx.
rewrite le_maxr; apply/orP; right; apply: le_trans (largest_ofP F _ (in_all_plans j ok okp)).
case: (ltnP (p j) (size (owners w))) => [jl|ge]; last by rewrite !nth_default ?size_map ?size_zip ?st ?out_size ?minnn.
by rewrite /kept (nth_map (false, d0)) ?size_zip ?st ?out_size ?minnn // nth_zip ?st ?out_size //= jB.
Qed.
End Checker.
