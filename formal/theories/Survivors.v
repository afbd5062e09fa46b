(** The survivor bound: RATT with the paper's number of baits, where every allowed attack is refined by one that leaves
    no group with more than [s] seeing robots. Any graph, budgets and protected parts. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees Planner GroupSize NMax.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

(** What is added robot by robot compares as the steps do. *)
Lemma telescope (F : realDomainType) (R : finType) (f h : {set R} -> F) (S0 S : {set R}) : S0 \subset S ->
  (forall i (T : {set R}), i \in S -> i \notin T -> f (i |: T) - f T <= h (i |: T) - h T) ->
  f S - f S0 <= h S - h S0.
Proof.
move: {2}#|S :\: S0| (erefl #|S :\: S0|) => n; elim: n S => [|n IH] S c sub step.
  have -> : S = S0 by apply/eqP; rewrite eqEsubset sub andbT -setD_eq0 -cards_eq0 c.
  by rewrite !subrr.
have /card_gt0P[i iS] : (0 < #|S :\: S0|)%N by rewrite c.
have [i0 iin] : i \notin S0 /\ i \in S by move: iS; rewrite inE => /andP[].
have sub' : S0 \subset S :\ i by rewrite subsetD1 sub.
have cT : #|(S :\ i) :\: S0| = n.
  by have := cardsD1 i (S :\: S0); rewrite iS c setDDl [S0 :|: _]setUC -setDDl => -[].
have rest : f (S :\ i) - f S0 <= h (S :\ i) - h S0.
  by apply: IH => // j T; rewrite !inE => /andP[_ jS]; apply: step.
have := step i (S :\ i) iin; rewrite setD11 setD1K // => /(_ isT) last.
by have := ler_add last rest; rewrite !addrA !subrK.
Qed.

Section Survivors.
Variables (F : realFieldType) (R E : finType) (t : team R E) (phi : {set E} -> F) (default : E) (s : nat) (robot0 : R).
Hypothesis every_robot_owns : forall i, exists x, owner t x = i.
Hypotheses (n0 : normalised phi) (mono : non_decreasing t phi).
(** Every allowed attack is refined by an allowed one that leaves few seeing robots together. *)
Hypothesis few : forall a, allowed t a -> exists2 a', allowed t a' &
  (forall i, exists j, sees t a' i \subset sees t a j) /\ forall i, (#|sees t a' i| <= s)%N.

Local Notation u := (paper_ratt t phi default).
Local Notation baits := (bait t phi default (alpha_s t + alpha_cs t)).
Local Notation n := (s.-1%:R : F).
Let worth i := alone phi (best t phi default i).

Lemma ratt_bg : bait_or_greedy t phi u (map (owner t) (ratt_picks t phi default (alpha_s t + alpha_cs t))).
Proof. exact: ratt_bait_or_greedy. Qed.
Lemma u_plan : is_plan t u. Proof. by case: ratt_bg. Qed.

Lemma single_worth o i : is_plan t o -> phi [set o i] <= worth i.
Proof. by move=> oko; rewrite -[X in worth X](plan_owner i oko); apply: best_max. Qed.
Lemma u_bait i : i \in baits -> phi [set u i] = worth i.
Proof. by move=> ib; rewrite ffunE ib. Qed.

Lemma set_mono o (A B : {set R}) : is_plan t o -> A \subset B -> phi (contributed o A) <= phi (contributed o B).
Proof. by move=> oko AB; apply: mono; [exact: plan_feasible oko | apply: imsetS]. Qed.
Lemma contributed1 (o : {ffun R -> E}) i : contributed o [set i] = [set o i].
Proof. by rewrite /contributed imset_set1. Qed.
Lemma single_ge0 o i : is_plan t o -> 0 <= phi [set o i].
Proof.
by move=> oko; have := set_mono oko (sub0set [set i]); rewrite contributed1 /contributed imset0 n0.
Qed.

(** ** Baits and the first greedy robot *)
Local Notation order := (by_value t phi default).

Lemma index_lt i : (index i order < #|R|)%N.
Proof. by rewrite -(order_size t phi default) index_mem mem_order. Qed.
Lemma worth_index i j : (index i order <= index j order)%N -> worth j <= worth i.
Proof.
move=> le; have := @order_le F R E t phi default robot0 (index i order) (index j order).
by rewrite le index_lt !nth_index ?mem_order //; apply.
Qed.
Lemma baitsE i : (i \in baits) = (index i order < alpha_s t + alpha_cs t)%N.
Proof. by rewrite in_take // mem_order. Qed.

Lemma baits_above i j : j \in baits -> i \notin baits -> worth i <= worth j.
Proof. by rewrite !baitsE -leqNgt => lt le; apply/worth_index/ltnW/(leq_trans lt le). Qed.

(** Of a set the first in RATT's order: if it is no bait, none is. *)
Lemma first_robot (S : {set R}) : S != set0 ->
  exists2 r, r \in S & (forall i, i \in S -> worth i <= worth r) /\ (r \notin baits -> forall i, i \in S -> i \notin baits).
Proof.
case/set0Pn => i0 iS; have found : has (fun i => i \in S) order by apply/hasP; exists i0; rewrite ?mem_order.
pose r := nth robot0 order (find (fun i => i \in S) order); have lt := found; rewrite has_find in lt.
have ir : index r order = find (fun i => i \in S) order by rewrite index_uniq ?order_uniq.
have le i : i \in S -> (index r order <= index i order)%N.
  move=> iin; rewrite ir leqNgt; apply/negP => h; have := @before_find _ robot0 (fun i => i \in S) order _ h.
  by rewrite nth_index ?mem_order // iin.
exists r; first exact: (@nth_find _ robot0 (fun i => i \in S)).
split=> [i iin|]; first exact: worth_index (le i iin).
by rewrite baitsE -leqNgt => rb i iin; rewrite baitsE -leqNgt; apply: leq_trans rb (le i iin).
Qed.

Lemma greedy_first i0 : i0 \notin baits ->
  exists2 r, r \notin baits & forall o i, is_plan t o -> i \notin baits -> phi [set o i] <= phi [set u r].
Proof.
move=> nb; set cand := [seq x <- enum E | owner t x \notin baits].
have inc o i : is_plan t o -> i \notin baits -> o i \in cand.
  by move=> oko ib; rewrite mem_filter (plan_owner _ oko) ib mem_enum.
case ec: cand (inc u i0 u_plan nb) => [//|x c] _; pose y := first_max (fun z => phi (z |: set0)) x c.
have yc : y \in cand by rewrite ec; apply: first_max_in.
have R0 : (0 < #|R|)%N by apply/card_gt0P; exists robot0.
have picks : exists rest, ratt_picks t phi default (alpha_s t + alpha_cs t) = y :: rest.
  by rewrite /ratt_picks -/cand ec -(prednK R0) greedy_picksS; eexists.
exists (owner t y); first by move: yc; rewrite mem_filter => /andP[].
move=> o i oko ib; have [rest e] := picks; have [_ _ _ greedy] := ratt_bg; rewrite e /= in greedy.
have := greedy (owner t y) y; rewrite mem_head /before /= eqxx /= => /(_ isT erefl).
rewrite (_ : [set j in [::]] = set0) ?/contributed ?imset0 ?setU0 => [le|]; last by apply/setP => j; rewrite !inE.
apply: le_trans le; have := @first_max_ge F E (fun z => phi (z |: set0)) x c (o i).
by rewrite -ec inc // -/y !setU0; apply.
Qed.

(** A group without bait and without one of the greedy robots: elsewhere at least as many baits see together. *)
Lemma counting a i r : allowed t a -> (forall j, j \in sees t a i -> j \notin baits) -> r \notin baits -> r \notin sees t a i ->
  exists T : {set R}, [/\ (#|sees t a i| <= #|T|)%N, forall j, j \in T -> j \in baits & exists j0, T \subset sees t a j0].
Proof.
move=> oka nobait rb rS; case/and5P: (oka) => bl cb sub _ safe.
have okC : allowed t (set0, cut a).
  by rewrite /allowed /= cards0 leq0n cb sub safe /= andbT disjoint_subset; apply/subsetP => x; rewrite in_set0.
have R0 : (0 < #|R|)%N by apply/card_gt0P; exists robot0.
have [i0 e] := eq_bigmax (fun i => #|group t (set0, cut a) i|) R0.
have nm : (n_max t <= #|group t a i0|)%N by have := n_max_le okC; rewrite /largest_group e.
set S := sees t a i in nobait rS *; pose D := sees t a i0; pose NB := [set j | j \notin baits].
have gR : (#|group t a i0| <= #|R|)%N by apply: max_card.
have cD : (n_max t - alpha_s t <= #|D|)%N.
  rewrite /D /sees cardsD; apply: leq_sub => //; apply: leq_trans bl; exact: subset_leq_card (subsetIr _ _).
have cNB : #|NB| = (n_max t - alpha_s t)%N.
  have ub : uniq baits by apply: take_uniq (order_uniq t phi default).
  have := cardsC [set j in baits]; rewrite cardsE (card_uniqP ub) size_take order_size.
  have -> : ~: [set j in baits] = NB by apply/setP => j; rewrite !inE.
  by rewrite /alpha_cs; case: ltnP; lia.
have SNB : S \subset NB by apply/subsetP => j /nobait; rewrite inE.
have lt : (#|S| < #|NB|)%N.
  by apply: proper_card; apply/properP; split=> //; exists r; first by rewrite inE.
have apart j : j \in S -> j \notin D.
  move=> jS; apply/negP => jD; move: jS jD lt; rewrite cNB !inE => /andP[_ ij] /andP[_ i0j].
  have e0 : connect (linked t a) i i0 by apply: connect_trans ij _; rewrite connect_linked_sym.
  have eS : S = D.
    apply/setP => k; rewrite !inE; congr (_ && _); apply/idP/idP => h; last exact: connect_trans e0 h.
    by apply: connect_trans h; rewrite connect_linked_sym.
  by rewrite eS ltnNge cD.
exists (D :\: NB); split; last by exists i0; apply: subsetDl.
  rewrite cardsD; have : (#|D :&: NB| <= #|NB :\: S|)%N.
    apply: subset_leq_card; apply/subsetP => j /setIP[jD jNB]; rewrite inE jNB andbT.
    by apply: contraL jD; apply: apart.
  by rewrite cardsD (setIidPr SNB) cNB; lia.
by move=> j /setDP[_]; rewrite inE negbK.
Qed.

(** ** What both classes give: [q] is [1 - k] or [1 - c], [b] is 1 or [1 - c] *)
Section Class.
Variables (q b : F).
Hypotheses (q0 : 0 <= q) (q1 : q <= 1) (b0 : 0 <= b) (qb : q <= b).
Hypothesis compared : forall o i (T : {set R}), is_plan t o -> i \notin T ->
  q ^+ 2 * marginal phi (o i) (contributed o T) <= marginal phi (u i) (contributed u T).
Hypothesis at_most : forall o i (T : {set R}), is_plan t o -> i \notin T ->
  b * marginal phi (o i) (contributed o T) <= phi [set o i].
Hypothesis at_least : forall i (T : {set R}), i \notin T ->
  q * phi [set u i] <= marginal phi (u i) (contributed u T).

Lemma shares_compare (x A y m : F) : 0 <= m -> b * A <= m * x -> x + q ^+ 2 * A <= y ->
  (b + m * q ^+ 2) * (x + A) <= (b + m) * y.
Proof.
move=> m0 hA hy; apply: le_trans (_ : (b + m) * (x + q ^+ 2 * A) <= _); last first.
  by apply: ler_wpmul2l hy; rewrite addr_ge0.
rewrite -subr_ge0; have -> : (b + m) * (x + q ^+ 2 * A) - (b + m * q ^+ 2) * (x + A) = (m * x - b * A) * (1 - q ^+ 2).
  by ring.
by rewrite mulr_ge0 // subr_ge0 // expr_le1.
Qed.

Lemma grown o (S : {set R}) r x : is_plan t o -> r \in S -> (forall i, i \in S -> phi [set o i] <= x) ->
  b * (phi (contributed o S) - phi [set o r]) <= (#|S|.-1)%:R * x.
Proof.
move=> oko rS low; have sub : [set r] \subset S by rewrite sub1set.
have := @telescope F R (fun T => b * phi (contributed o T)) (fun T => #|T|%:R * x) _ _ sub.
rewrite contributed1 cards1 mul1r -mulrBr => h; apply: le_trans (h _) _ => [i T iS iT|].
  rewrite cardsU1 iT natrD mulrDl mul1r addrK -mulrBr contributedU1; apply: le_trans (low i iS).
  exact: at_most.
have c0 : (0 < #|S|)%N by apply/card_gt0P; exists r.
by rewrite -{1}(prednK c0) -addn1 natrD mulrDl mul1r addrK.
Qed.

Lemma size_left (S : {set R}) r : r \in S -> (#|S| <= s)%N -> (#|S|.-1)%:R <= n.
Proof. by move=> rS c; rewrite ler_nat -!subn1 leq_sub2r. Qed.

(** The set has a robot whose element is worth as much as any of the other plan's. *)
Lemma share_here o (S : {set R}) r : is_plan t o -> r \in S -> (#|S| <= s)%N ->
  (forall i, i \in S -> phi [set o i] <= phi [set u r]) ->
  (b + n * q ^+ 2) * phi (contributed o S) <= (b + n) * phi (contributed u S).
Proof.
move=> oko rS cS low; set A := phi (contributed o S) - phi [set o r]; set x := phi [set u r].
have x0 : 0 <= x := single_ge0 r u_plan.
have sub : [set r] \subset S by rewrite sub1set.
have hy : x + q ^+ 2 * A <= phi (contributed u S).
  have h := @telescope F R (fun T => q ^+ 2 * phi (contributed o T)) (fun T => phi (contributed u T)) _ _ sub.
  rewrite !contributed1 -mulrBr -/A -/x in h; rewrite addrC -ler_subr_addr; apply: h => i T _ iT.
  rewrite -mulrBr !contributedU1; exact: compared.
have hA : b * A <= n * x.
  by apply: le_trans (grown oko rS low) _; apply: ler_wpmul2r x0 _ _ (size_left rS cS).
apply: le_trans (shares_compare (ler0n _ _) hA hy); apply: ler_wpmul2l.
  by rewrite addr_ge0 // mulr_ge0 ?ler0n ?sqr_ge0.
by rewrite -(subrK (phi [set o r]) (phi (contributed o S))) -/A addrC ler_add2r low.
Qed.

(** As many robots elsewhere have elements worth as much as any of the other plan's. *)
Lemma share_elsewhere o (S T : {set R}) r w : is_plan t o -> r \in S -> (#|S| <= s)%N -> (#|S| <= #|T|)%N ->
  (forall i, i \in S -> phi [set o i] <= w) -> (forall j, j \in T -> w <= phi [set u j]) -> 0 <= w ->
  (b + n * q ^+ 2) * phi (contributed o S) <= (b + n) * phi (contributed u T).
Proof.
move=> oko rS cS cT low high w0; set A := phi (contributed o S) - phi [set o r]; set m := (#|S|.-1)%:R : F.
have hb : b * A <= m * w := grown oko rS low.
have A0 : 0 <= A by rewrite subr_ge0 -contributed1; apply: set_mono; rewrite ?sub1set.
have S0 : (0 < #|S|)%N by apply/card_gt0P; exists r.
have /card_gt0P[j jT] : (0 < #|T|)%N by apply: leq_trans cT.
have sub : [set j] \subset T by rewrite sub1set.
have up : w + (#|T|.-1)%:R * (q * w) <= phi (contributed u T).
  have := @telescope F R (fun V => #|V|%:R * (q * w)) (fun V => phi (contributed u V)) _ _ sub.
  rewrite contributed1 cards1 mul1r => h; have {h} h := h _.
  have e : #|T|%:R * (q * w) - q * w = (#|T|.-1)%:R * (q * w).
    have c0 : (0 < #|T|)%N by apply: leq_trans cT.
    by rewrite -{1}(prednK c0) -addn1 natrD mulrDl mul1r addrK.
  rewrite e in h; rewrite -(subrK (phi [set u j]) (phi (contributed u T))) addrC; apply: ler_add (high j jT).
  apply: h => i V iT iV; rewrite cardsU1 iV natrD mulrDl mul1r addrK contributedU1.
  by apply: le_trans (at_least iV); apply: ler_wpmul2l (high i iT).
have hy : w + q ^+ 2 * A <= phi (contributed u T).
  apply: le_trans up; rewrite ler_add2l expr2 -mulrA; apply: le_trans (_ : q * (m * w) <= _).
    by apply: ler_wpmul2l => //; apply: le_trans hb; apply: ler_wpmul2r.
  by rewrite mulrCA; apply: ler_wpmul2r; [apply: mulr_ge0 | rewrite ler_nat -!subn1 leq_sub2r].
have hA : b * A <= n * w by apply: le_trans hb _; apply: ler_wpmul2r w0 _ _ (size_left rS cS).
apply: le_trans (shares_compare (ler0n _ _) hA hy); apply: ler_wpmul2l.
  by rewrite addr_ge0 // mulr_ge0 ?ler0n ?sqr_ge0.
by rewrite -(subrK (phi [set o r]) (phi (contributed o S))) -/A addrC ler_add2r low.
Qed.
Lemma after_attack o a i : is_plan t o -> allowed t a -> (#|sees t a i| <= s)%N ->
  exists j, (b + n * q ^+ 2) * phi (contributed o (sees t a i)) <= (b + n) * phi (contributed u (sees t a j)).
Proof.
move=> oko oka cS; set S := sees t a i in cS *.
have [e|/first_robot[r rS [top nob]]] := eqVneq S set0.
  by exists i; rewrite -/S e /contributed !imset0 n0 !mulr0.
have low j : j \in S -> phi [set o j] <= worth r by move=> jS; apply: le_trans (single_worth j oko) (top j jS).
case: (boolP (r \in baits)) => [rb|rb].
  by exists i; apply: (share_here oko rS cS) => j; rewrite u_bait //; apply: low.
have [r1 r1b first] := greedy_first rb.
case: (boolP (r1 \in S)) => r1S.
  by exists i; apply: (share_here oko r1S cS) => j jS; apply: first => //; apply: nob rb j jS.
have [T [cT bT [j0 sub]]] := counting oka (nob rb) r1b r1S; exists j0.
apply: le_trans (_ : (b + n) * phi (contributed u T) <= _); last first.
  by apply: ler_wpmul2l; [rewrite addr_ge0 ?ler0n | apply: set_mono u_plan sub].
apply: (share_elsewhere oko rS cS cT low) => [j jT|].
  by rewrite u_bait ?bT //; exact: baits_above (bT j jT) rb.
exact: le_trans (single_ge0 r oko) (low r rS).
Qed.

Lemma survivor_share : (b + n * q ^+ 2) * optimum t phi <= (b + n) * worst_case t phi u.
Proof.
have [[o oko <-] _] := optimumP phi u_plan; have [a oka ->] := worst_case_attained t phi u.
have [a' oka' [finer small]] := few oka; have b'0 : 0 <= b + n by rewrite addr_ge0 ?ler0n.
apply: le_trans (_ : (b + n * q ^+ 2) * team_value t phi o a' <= _).
  by apply: ler_wpmul2l; [rewrite addr_ge0 ?mulr_ge0 ?ler0n ?sqr_ge0 | apply: worst_case_le].
have [i ->] := team_value_attained t phi o a' robot0; have [j le] := after_attack oko oka' (small i).
apply: le_trans le _; apply: ler_wpmul2l => //; have [k sub] := finer j.
exact: le_trans (set_mono u_plan sub) (le_team_value t phi u a k).
Qed.
End Class.

Theorem survivor_submodular k : 0 <= k <= 1 -> submodular t phi -> curvature_at_most t phi k ->
  (1 + n * (1 - k) ^+ 2) * optimum t phi <= (1 + n) * worst_case t phi u.
Proof.
move=> /andP[k0 k1] sub curv; have up := u_plan; have q0 : 0 <= 1 - k by rewrite subr_ge0.
have q1 : 1 - k <= 1 by rewrite ler_subl_addr ler_addl.
have alone_least p i (T : {set R}) : is_plan t p -> i \notin T -> marginal phi (p i) (contributed p T) <= phi [set p i].
  move=> okp iT; apply: le_trans (_ : marginal phi (p i) set0 <= _); last by rewrite /marginal setU0 n0 subr0.
  by apply: sub; rewrite ?sub0set ?(extend_notin okp) ?(extend_feasible okp) ?(plan_owner _ okp).
have least i (T : {set R}) : i \notin T -> (1 - k) * phi [set u i] <= marginal phi (u i) (contributed u T).
  by move=> iT; apply: curv; rewrite ?(extend_notin up) ?(extend_feasible up) ?(plan_owner _ up).
apply: (survivor_share q0 q1 ler01 q1 _ _ least) => [o i T oko iT|o i T oko iT].
  rewrite expr2 -mulrA; apply: le_trans (least i T iT); apply: ler_wpmul2l => //.
  apply: le_trans (_ : (1 - k) * phi [set o i] <= _); first by apply: ler_wpmul2l => //; apply: alone_least.
  have [_ _ isbait isgreedy] := ratt_bg; set g := map _ _ in isbait isgreedy.
  case: (boolP (i \in g)) => ig; last first.
    by apply: le_trans (isbait i (o i) ig (plan_owner i oko)); rewrite ler_pimull ?single_ge0.
  have nb : i \notin [set j in take (index i g) g] by rewrite inE take_index_notin.
  apply: le_trans (alone_least _ _ _ u_plan nb); apply: le_trans (_ : marginal phi (o i) (before u g i) <= _).
    by apply: curv; rewrite ?(extend_notin up) ?(extend_feasible up) ?(plan_owner _ oko).
  by rewrite /marginal ler_add2r; apply: isgreedy => //; rewrite (plan_owner _ oko).
by rewrite mul1r; apply: alone_least.
Qed.

Theorem survivor_total_curvature c : 0 <= c <= 1 -> total_curvature_at_most t phi c ->
  ((1 - c) + n * (1 - c) ^+ 2) * optimum t phi <= ((1 - c) + n) * worst_case t phi u.
Proof.
move=> /andP[c0 c1] curv; have up := u_plan; have q0 : 0 <= 1 - c by rewrite subr_ge0.
have q1 : 1 - c <= 1 by rewrite ler_subl_addr ler_addl.
have none x : feasible t [set x].
  by apply/forall_inP => y; rewrite inE => /eqP->; apply/forall_inP => z; rewrite inE => /eqP->; rewrite !eqxx.
have single p i : phi [set p i] = marginal phi (p i) set0 by rewrite /marginal setU0 n0 subr0.
apply: (survivor_share q0 q1 q0 (lexx _)) => [o i T oko iT|o i T oko iT|i T iT].
- exact: non_decreasing_step curv _ _ _ _ _ ratt_bg oko iT.
- by rewrite single; apply: curv; rewrite ?setU0 ?in_set0 ?none ?(extend_notin oko) ?(extend_feasible oko) ?(plan_owner _ oko).
- by rewrite single; apply: curv; rewrite ?setU0 ?in_set0 ?none ?(extend_notin up) ?(extend_feasible up) ?(plan_owner _ up).
Qed.
End Survivors.
