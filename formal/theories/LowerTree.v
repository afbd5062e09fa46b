(** The lower proof: covers of all attacks by cases in which some robots are known to see in one group. Generic in the
    value: [worth] decides whether a set of robots is worth the claim. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify.
From Ratt Require Import Extrema Teams Graph Worth.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** A robot is blinded or sees; a robot is in the group of one of the parts or of none; the case is beyond the budgets;
    the robots of a part that are known to see are worth the claim. *)
Inductive attack_tree :=
| Blinded of nat & attack_tree & attack_tree
| Group of nat & seq attack_tree
| Beyond
| Worth of nat.

(** A robot is in the set or not; the set is worth the claim; too few robots are left; the average leaf. *)
Inductive size_tree :=
| Taken of nat & size_tree & size_tree
| SetWorth
| TooFew
| Average.

Lemma le_foldr_max (f : nat -> nat) (s : seq nat) x : x \in s -> (f x <= foldr maxn 0 (map f s))%N.
Proof.
elim: s => [//|y s IH]; rewrite in_cons /= => /orP[/eqP->|/IH h]; first exact: leq_maxl.
exact: leq_trans h (leq_maxr _ _).
Qed.

Section Lost.
Variables (w : network) (near : seq (seq nat)).
Definition placed (parts : seq (seq nat)) (i : nat) : bool := has (fun P : seq nat => i \in P) parts.
Definition home (parts : seq (seq nat)) (i : nat) : nat := find (fun P : seq nat => i \in P) parts.
Definition split_link (parts : seq (seq nat)) (l : link) : bool :=
  [&& placed parts l.1, placed parts l.2 & home parts l.1 != home parts l.2].
(** Links that a robot in no part loses at least: all to the parts but those to the best linked one. *)
Definition lost_by (parts : seq (seq nat)) (i : nat) : nat :=
  let homes := [seq home parts j | j <- nth [::] near i & placed parts j] in
  size homes - foldr maxn 0 [seq count_mem q homes | q <- homes].
Definition lost (parts : seq (seq nat)) : nat :=
  count (split_link parts) (link_list w) +
  sumn [seq lost_by parts i | i <- iota 0 (robots w) & ~~ placed parts i].
Definition beyond (blind : seq nat) (parts : seq (seq nat)) : bool :=
  [|| (blind_budget w < size blind)%N, (cut_budget w < lost parts)%N, has (fun i => i \in kept_robots w) blind
    | has (fun l => (l \in kept_links w) && split_link parts l) (link_list w)].
End Lost.

Section Trees.
Variables (w : network) (near : seq (seq nat)) (S : Type) (start : S) (add : S -> nat -> S) (worth : S -> bool).
Variable (average_worth : S -> seq nat -> nat -> bool).

Fixpoint check_attacks (t : attack_tree) (blind see : seq nat) (parts : seq (seq nat)) {struct t} : bool :=
  match t with
  | Blinded i t1 t2 =>
      [&& (i < robots w)%N, i \notin blind, i \notin see, check_attacks t1 (i :: blind) see parts
        & check_attacks t2 blind (i :: see) parts]
  | Group i kids =>
      [&& (i < robots w)%N, ~~ placed parts i, size kids == (size parts).+1
        & (fix go (l : seq attack_tree) (q : nat) {struct l} : bool :=
             if l is t' :: l' then
               check_attacks t' blind see (set_nth [::] parts q (rcons (nth [::] parts q) i)) && go l' q.+1
             else true) kids 0%N]
  | Beyond => beyond w near blind parts
  | Worth q => (q < size parts)%N && worth (foldl add start [seq i <- nth [::] parts q | i \in see])
  end.

Fixpoint check_sizes (size_k : nat) (t : size_tree) (s : S) (decided : seq nat) (out : nat) {struct t} : bool :=
  match t with
  | Taken i t1 t2 =>
      [&& (i < robots w)%N, i \notin decided, check_sizes size_k t1 (add s i) (i :: decided) out
        & check_sizes size_k t2 s (i :: decided) out.+1]
  | SetWorth => worth s
  | TooFew => (robots w < size_k + out)%N
  | Average =>
      let missing := size_k - (size decided - out) in
      (0 < missing)%N && average_worth s [seq i <- iota 0 (robots w) | i \notin decided] missing
  end.
End Trees.

Section Soundness.
Local Open Scope ring_scope.
Variables (w : network) (near : seq (seq nat)) (S : Type) (start : S) (add : S -> nat -> S) (worth : S -> bool).
Variable (average_worth : S -> seq nat -> nat -> bool).
Hypotheses (ok : network_ok w) (nearE : near = [seq neighbours (link_list w) i | i <- iota 0 (robots w)]).
Local Notation robot := 'I_(top_robot w).+1.
Local Notation element := 'I_(top_element w).+1.
Variables (F : realFieldType) (phi : {set element} -> F) (p : {ffun robot -> element}) (lower : F).
Local Notation below := (fun i => (i < robots w)%N).

Hypotheses (worthP : worth_test start add phi p lower worth) (averageP : average_test start add phi p lower average_worth).

Variable a : attack [finType of robot].
Hypothesis oka : allowed (team_of w) a.
Local Notation con i j := (connect (linked (team_of w) a) (robot_of w i) (robot_of w j)).

Lemma conC i j : con i j = con j i.
Proof. exact: connect_linked_sym. Qed.
Lemma con_trans j i k : con i j -> con j k -> con i k.
Proof. exact: connect_trans. Qed.

(** What a case says about the attack. *)
Record case_of (blind see : seq nat) (parts : seq (seq nat)) : Prop := CaseOf {
  blind_uniq : uniq blind;
  blind_in : forall i, i \in blind -> (i < robots w)%N && (robot_of w i \in blinded a);
  see_in : forall i, i \in see -> (i < robots w)%N && (robot_of w i \notin blinded a);
  parts_in : forall q, (q < size parts)%N -> [/\ nth [::] parts q != [::], uniq (nth [::] parts q),
    all below (nth [::] parts q) & forall i, i \in nth [::] parts q -> con (head 0%N (nth [::] parts q)) i];
  parts_apart : forall q r, (q < size parts)%N -> (r < size parts)%N -> q != r ->
    ~~ con (head 0%N (nth [::] parts q)) (head 0%N (nth [::] parts r))
}.

Section Beyond.
Variables (blind see : seq nat) (parts : seq (seq nat)).
Hypothesis c : case_of blind see parts.

Lemma placed_home i : placed parts i -> (home parts i < size parts)%N /\ i \in nth [::] parts (home parts i).
Proof. by move=> h; rewrite /home -has_find; split=> //; apply: (nth_find [::] h). Qed.

Lemma con_home i : placed parts i -> con (head 0%N (nth [::] parts (home parts i))) i.
Proof. by case/placed_home => lt inp; have [_ _ _] := parts_in c lt; apply. Qed.

Lemma cut_apart l : l \in link_list w -> ~~ con l.1 l.2 -> link_of w l \in cut a.
Proof.
move=> lw; apply: contraR => nc; apply: connect1.
have /allP/(_ _ lw) := links_ok ok; rewrite /link_ok => /andP[l12 l2].
rewrite /linked in_setD nc /= -val_eqE /= !robot_ofK ?(ltn_trans l12) // ltn_eqF //=.
by rewrite inE; apply: map_f.
Qed.

Lemma split_apart l : split_link parts l -> ~~ con l.1 l.2.
Proof.
case/and3P=> p1 p2 ne; apply/negP => c12.
have [lt1 _] := placed_home p1; have [lt2 _] := placed_home p2.
have /negP := parts_apart c lt1 lt2 ne; apply.
by apply: con_trans (con_trans (con_home p1) c12) _; rewrite conC con_home.
Qed.

Definition friend (i : nat) : nat := find (fun P : seq nat => con (head 0%N P) i) parts.

Lemma friend_apart i j : placed parts j -> home parts j != friend i -> ~~ con i j.
Proof.
move=> pj ne; apply/negP => cij; have [lt _] := placed_home pj.
have chi : con (head 0%N (nth [::] parts (home parts j))) i.
  by apply: con_trans (con_home pj) _; rewrite conC.
have hasi : has (fun P : seq nat => con (head 0%N P) i) parts.
  by apply/hasP; exists (nth [::] parts (home parts j)); rewrite ?mem_nth.
have ltf : (friend i < size parts)%N by rewrite /friend -has_find.
have := parts_apart c lt ltf ne => /negP; apply.
by apply: con_trans chi _; rewrite conC; apply: (nth_find [::] hasi).
Qed.

Lemma cut_count : (count (fun l => link_of w l \in cut a) (link_list w) <= cut_budget w)%N.
Proof.
case/and5P: oka => _ le _ _ _; apply: leq_trans le.
rewrite -size_filter -(size_map (link_of w)) cardE; apply: uniq_leq_size.
  rewrite map_inj_in_uniq ?filter_uniq ?links_uniq // => l m; rewrite !mem_filter => /andP[_ lw] /andP[_ mw].
  by have /allP lok := links_ok ok; apply: link_of_inj (lok _ lw) (lok _ mw).
by move=> l /mapP[m]; rewrite mem_filter mem_enum => /andP[h _] ->.
Qed.

Definition loses (i : nat) (l : link) : bool :=
  ((l.1 == i) && placed parts l.2 && (home parts l.2 != friend i)) ||
  ((l.2 == i) && placed parts l.1 && (home parts l.1 != friend i)).

Lemma lost_by_le i : (i < robots w)%N -> (lost_by near parts i <= count (loses i) (link_list w))%N.
Proof.
move=> il; rewrite /lost_by nearE (nth_map 0%N) ?size_iota // nth_iota // add0n.
set homes := map _ _; apply: (@leq_trans (count (fun q => q != friend i) homes)).
  rewrite -(count_predC (pred1 (friend i)) homes) leq_subLR leq_add2r.
  have [inh|nin] := boolP (friend i \in homes); last by rewrite (count_memPn nin).
  exact: (le_foldr_max (fun q => count_mem q homes)).
rewrite /homes count_map count_filter /neighbours count_cat !count_map !count_filter /=.
rewrite -count_predUI [X in (_ + X)%N](_ : _ = 0%N) ?addn0.
  by apply: sub_count => l /=; rewrite /loses => /orP[] /andP[/andP[-> ->] ->]; rewrite ?orbT.
apply/eqP; rewrite -leqn0 leqNgt -has_count; apply/hasP => -[l lw] /=.
case/andP=> /andP[_ /eqP e1] /andP[_ /eqP e2].
by have /allP/(_ _ lw) := links_ok ok; rewrite /link_ok e1 e2 ltnn.
Qed.

Lemma count_loses l : l \in link_list w ->
  (split_link parts l + \sum_(i <- iota 0 (robots w) | ~~ placed parts i) loses i l <= (link_of w l \in cut a))%N.
Proof.
move=> lw; have /allP/(_ _ lw) := links_ok ok; rewrite /link_ok => /andP[l12 l2]; have l1 := ltn_trans l12 l2.
have one x (P : pred nat) : (x < robots w)%N ->
    (\sum_(i <- iota 0 (robots w) | ~~ placed parts i) ((x == i) && P i) = ~~ placed parts x && P x)%N.
  move=> xl; rewrite big_mkcond (bigD1_seq x) ?iota_uniq ?mem_iota //= big1 => [|i ne].
    by rewrite eqxx addn0; case: (placed parts x).
  by rewrite eq_sym (negbTE ne) if_same.
have -> : (\sum_(i <- iota 0 (robots w) | ~~ placed parts i) loses i l =
    (~~ placed parts l.1 && (placed parts l.2 && (home parts l.2 != friend l.1))) +
    (~~ placed parts l.2 && (placed parts l.1 && (home parts l.1 != friend l.2))))%N.
  rewrite -(one l.1 (fun i => placed parts l.2 && (home parts l.2 != friend i)) l1).
  rewrite -(one l.2 (fun i => placed parts l.1 && (home parts l.1 != friend i)) l2) -big_split; apply: eq_bigr => i _; rewrite /loses -!andbA.
  have [e1|_] := eqVneq l.1 i; have [e2|_] := eqVneq l.2 i; rewrite /= ?orbF ?addn0 ?add0n //.
  by move: l12; rewrite e1 e2 ltnn.
have cutl : split_link parts l || (placed parts l.2 && (home parts l.2 != friend l.1)) ||
    (placed parts l.1 && (home parts l.1 != friend l.2)) -> link_of w l \in cut a.
  move=> h; apply: cut_apart => //; case/orP: h => [/orP[|]|] h; first exact: split_apart.
    by case/andP: h; apply: friend_apart.
  by case/andP: h => h1 h2; rewrite conC; apply: friend_apart h1 h2.
move: cutl; rewrite /split_link; case: (placed parts l.1); case: (placed parts l.2);
  case: (home parts l.1 != home parts l.2); case: (home parts l.2 != friend l.1);
  by case: (home parts l.1 != friend l.2) => //= h; rewrite h.
Qed.

Lemma lost_cut : (lost w near parts <= cut_budget w)%N.
Proof.
have countE (P : pred link) (r : seq link) : count P r = (\sum_(l <- r) P l)%N.
  by rewrite -sum1_count big_mkcond; apply: eq_bigr => l _; case: (P l).
apply: leq_trans cut_count; rewrite /lost !countE sumnE big_map big_filter.
apply: (@leq_trans (\sum_(l <- link_list w)
  (split_link parts l + \sum_(i <- iota 0 (robots w) | ~~ placed parts i) loses i l))%N); last first.
  by rewrite big_seq_cond [X in (_ <= X)%N]big_seq_cond; apply: leq_sum => l; rewrite andbT => /count_loses.
rewrite big_split /= leq_add2l exchange_big /= big_seq_cond [X in (_ <= X)%N]big_seq_cond; apply: leq_sum => i.
by rewrite -[_ :: _]/(iota 0 (robots w)) mem_iota add0n => /andP[/andP[_ il] _]; rewrite -countE; apply: lost_by_le.
Qed.

Lemma not_beyond : beyond w near blind parts = false.
Proof.
apply/negP; rewrite /beyond => /or4P[h|h|/hasP[i ib ik]|/hasP[l lw /andP[lk sp]]].
- case/and5P: oka => le _ _ _ _; have : (size blind <= #|blinded a|)%N; last by rewrite leqNgt (leq_ltn_trans le h).
  rewrite -(size_map (robot_of w)) cardE; apply: uniq_leq_size.
    rewrite map_inj_in_uniq ?(blind_uniq c) // => i j /(blind_in c)/andP[il _] /(blind_in c)/andP[jl _].
    by move/(congr1 (@nat_of_ord _)); rewrite !robot_ofK.
  by move=> x /mapP[i /(blind_in c)/andP[_ h'] ->]; rewrite mem_enum.
- by have := lost_cut; rewrite leqNgt h.
- case/and5P: oka => _ _ _ dis _; have /andP[il ia] := blind_in c ib.
  by have := disjointFr dis ia; rewrite inE robot_ofK // ik.
case/and5P: oka => _ _ _ _ dis; have lc := cut_apart lw (split_apart sp).
by have := disjointFr dis lc; rewrite inE map_f.
Qed.
End Beyond.

Lemma foldl_add s T : foldl add start (rcons T s) = add (foldl add start T) s.
Proof. by rewrite -cats1 foldl_cat. Qed.

Lemma check_attacksP t blind see parts : check_attacks w near start add worth t blind see parts ->
  case_of blind see parts -> lower <= team_value (team_of w) phi p a.
Proof.
move: t blind see parts; fix IH 1 => t blind see parts; case: t => [i t1 t2|i kids||q].
- rewrite [check_attacks _ _ _ _ _ _ _ _ _]/= => /and5P[il ib is_ h1 h2] c.
  have [ia|ia] := boolP (robot_of w i \in blinded a).
    apply: IH h1 _; case: c => c1 c2 c3 c4 c5; split=> //=; first by rewrite ib.
    by move=> j; rewrite in_cons => /orP[/eqP->|/c2 //]; rewrite il.
  apply: IH h2 _; case: c => c1 c2 c3 c4 c5; split=> //=.
  by move=> j; rewrite in_cons => /orP[/eqP->|/c3 //]; rewrite il.
- rewrite [check_attacks _ _ _ _ _ _ _ _ _]/= => /and4P[il np /eqP sz kids_ok] c.
  have notin q : (q < size parts)%N -> i \notin nth [::] parts q.
    by move=> ql; apply: contra np => h; apply/hasP; exists (nth [::] parts q); rewrite ?mem_nth.
  (* The child that the attack belongs to. *)
  have [r [rl cr]] : exists r, (r < size kids)%N /\
      case_of blind see (set_nth [::] parts r (rcons (nth [::] parts r) i)).
    have [hasi|nohas] := boolP (has (fun P : seq nat => con (head 0%N P) i) parts).
      exists (find (fun P : seq nat => con (head 0%N P) i) parts); have := hasi; rewrite has_find => rl.
      split; first by rewrite sz ltnS ltnW.
      set r := find _ _ in rl *; have cri : con (head 0%N (nth [::] parts r)) i by apply: (nth_find [::] hasi).
      have szr : size (set_nth [::] parts r (rcons (nth [::] parts r) i)) = size parts.
        by rewrite size_set_nth; apply/maxn_idPr.
      have hd q : head 0%N (nth [::] (set_nth [::] parts r (rcons (nth [::] parts r) i)) q) =
          head 0%N (nth [::] parts q).
        rewrite nth_set_nth /=; case: eqP => // ->; have [ne _ _ _] := parts_in c rl.
        by case: (nth [::] parts r) ne.
      split; [exact: blind_uniq c|exact: blind_in c|exact: see_in c| |]; rewrite szr; last first.
        by move=> q q' ql q'l ne; rewrite !hd; exact: (parts_apart c ql q'l ne).
      move=> q ql; rewrite hd nth_set_nth /=; have [->|_] := eqVneq q r; last exact: (parts_in c ql).
      have [ne u b cn] := parts_in c rl; split.
      + by case: (nth _ _ _).
      + by rewrite rcons_uniq notin.
      + by rewrite all_rcons il.
      by move=> j; rewrite mem_rcons in_cons => /orP[/eqP->|/cn].
    exists (size parts); rewrite sz; split=> //; rewrite nth_default //=.
    have -> : set_nth [::] parts (size parts) [:: i] = rcons parts [:: i].
      by elim: (parts) => [//|P ps /= ->].
    have apart q : (q < size parts)%N -> ~~ con (head 0%N (nth [::] parts q)) i.
      move=> ql; apply: contra nohas => h; apply/hasP; by exists (nth [::] parts q); rewrite ?mem_nth.
    split; [exact: blind_uniq c|exact: blind_in c|exact: see_in c| |]; rewrite size_rcons.
      move=> q; rewrite ltnS leq_eqVlt nth_rcons => /orP[/eqP->|ql]; last by rewrite ql; exact: (parts_in c ql).
      rewrite ltnn eqxx; split=> //=; first by rewrite il.
      by move=> j; rewrite inE => /eqP->; apply: connect0.
    move=> q q'; rewrite !ltnS (leq_eqVlt q) (leq_eqVlt q') !nth_rcons => /orP[/eqP->|ql] /orP[/eqP->|q'l]; rewrite ?eqxx ?ltnn //.
    - by move=> _; rewrite q'l conC apart.
    - by move=> _; rewrite ql apart.
    by rewrite ql q'l => ne; exact: (parts_apart c ql q'l ne).
  have gen : forall q0, (q0 <= r)%N -> (r < q0 + size kids)%N ->
    (fix go (l : seq attack_tree) (q : nat) {struct l} : bool :=
       if l is t' :: l' then
         check_attacks w near start add worth t' blind see (set_nth [::] parts q (rcons (nth [::] parts q) i)) && go l' q.+1
       else true) kids q0 -> lower <= team_value (team_of w) phi p a.
    clear kids_ok sz rl; elim: kids => [|t kids IHk] q0 le lt; first by move: lt; rewrite /= addn0 ltnNge le.
    move=> /andP[h1 h2]; have [e|ne] := eqVneq q0 r; last first.
      by apply: (IHk q0.+1) => //; [rewrite ltn_neqAle ne le | move: lt; rewrite /= addSnnS].
    by apply: IH h1 _; rewrite e.
  by apply: (gen 0%N) => //; rewrite add0n.
- by rewrite [check_attacks _ _ _ _ _ _ _ _ _]/= => h /not_beyond e; rewrite e in h.
rewrite [check_attacks _ _ _ _ _ _ _ _ _]/= => /andP[ql wo] c.
have [ne u b cn] := parts_in c ql; set P := nth [::] parts q in ne u b cn wo *.
apply: le_trans (le_team_value (team_of w) phi p a (robot_of w (head 0%N P))).
apply: worthP wo _ _ => [||i]; first exact: filter_uniq.
  by apply/allP => i; rewrite mem_filter => /andP[_ /(allP b)].
by rewrite mem_filter => /andP[/(see_in c)/andP[_ ia] iP]; rewrite !inE ia cn.
Qed.

Theorem attack_treeP t : check_attacks w near start add worth t [::] [::] [::] ->
  lower <= team_value (team_of w) phi p a.
Proof. by move=> h; apply: check_attacksP h _. Qed.

(** ** Sets of a forced size *)
Lemma check_sizesP (k : nat) t (G : {set robot}) (T0 : seq nat) In decided out :
  uniq T0 -> all below T0 -> size T0 = k -> (forall i, i \in T0 -> robot_of w i \in G) ->
  uniq In -> {subset In <= decided} -> uniq decided -> all below decided -> size decided = (size In + out)%N ->
  (forall i, i \in decided -> (i \in T0) = (i \in In)) ->
  check_sizes w add worth average_worth k t (foldl add start In) decided out -> lower <= phi (contributed p G).
Proof.
move=> uT bT sT TG; elim: t In decided out => [i t1 IH1 t2 IH2|||] In decided out uI Id ud bd sd same.
- rewrite [check_sizes _ _ _ _ _ _ _ _ _]/= -foldl_add => /and4P[il id_ h1 h2].
  have iI : i \notin In by apply: contra id_ => /Id.
  have [iT|iT] := boolP (i \in T0).
    apply: IH1 h1; rewrite ?rcons_uniq ?iI //=.
    + by move=> j; rewrite mem_rcons !in_cons => /orP[->//|/Id ->]; rewrite orbT.
    + by rewrite id_.
    + by rewrite il.
    + by rewrite size_rcons sd.
    by move=> j; rewrite mem_rcons !in_cons => /orP[/eqP->|jd]; rewrite ?iT ?eqxx // same //; case: eqP => // e;
       rewrite -e jd in id_.
  apply: IH2 h2; rewrite ?id_ ?il //=.
  + by move=> j /Id; rewrite in_cons => ->; rewrite orbT.
  + by rewrite id_.
  + by rewrite il.
  + by rewrite sd addnS.
  by move=> j; rewrite in_cons => /orP[/eqP->|/same //]; rewrite (negbTE iT) (negbTE iI).
- move=> h; apply: worthP uI _ h _ _ => [|i iI]; first by apply/allP => i /Id /(allP bd).
  by apply: TG; rewrite same ?Id.
- move=> h; suff le : (k + out <= robots w)%N by move: h; rewrite [check_sizes _ _ _ _ _ _ _ _ _]/= ltnNge le.
  have uu : uniq (T0 ++ [seq i <- decided | i \notin T0]).
    rewrite cat_uniq uT filter_uniq // andbT; apply/hasP => -[j]; by rewrite mem_filter => /andP[/negbTE /= ->].
  have sub : {subset T0 ++ [seq i <- decided | i \notin T0] <= iota 0 (robots w)}.
    move=> j; rewrite mem_cat mem_iota add0n mem_filter => /orP[/(allP bT)//|/andP[_ /(allP bd)] //].
  have := uniq_leq_size uu sub; rewrite size_cat size_iota sT; apply: leq_trans.
  rewrite leq_add2l size_filter -(leq_add2l (size In)) -sd -(count_predC (fun i => i \in T0) decided) leq_add2r.
  rewrite -size_filter; apply: uniq_leq_size; first exact: filter_uniq.
  by move=> j; rewrite mem_filter => /andP[jT jd]; rewrite -same.
move=> /andP[r0 av]; set rest := [seq i <- _ | _] in av.
pose T' := [seq i <- T0 | i \notin decided].
have sIn : perm_eq [seq i <- T0 | i \in decided] In.
  apply: uniq_perm => //; first exact: filter_uniq.
  move=> j; rewrite mem_filter; apply/andP/idP => [[jd jT]|jI]; first by rewrite -same.
  by rewrite same ?Id.
have sz : size T' = (k - (size decided - out))%N.
  rewrite sd addnK -(perm_size sIn) -sT -(count_predC (fun i => i \in decided) T0) size_filter addKn.
  by rewrite /T' size_filter.
have bI : all below In by apply/allP => i /Id /(allP bd).
apply: (@averageP In rest _ uI bI r0 av T' G) => //.
- rewrite cat_uniq uI filter_uniq // andbT; apply/hasP => -[j]; rewrite mem_filter => /andP[jd _] /Id.
  by rewrite (negbTE jd).
- by apply/allP => j; rewrite mem_filter => /andP[_ /(allP bT)].
- by move=> j; rewrite !mem_filter mem_iota add0n => /andP[-> /(allP bT) ->].
move=> j; rewrite mem_cat mem_filter => /orP[jI|/andP[_ /TG //]]; apply: TG; by rewrite same ?Id.
Qed.

Theorem size_treeP k t (i : robot) : (k <= #|sees (team_of w) a i|)%N ->
  check_sizes w add worth average_worth k t start [::] 0 -> lower <= team_value (team_of w) phi p a.
Proof.
move=> ki h; apply: le_trans (le_team_value (team_of w) phi p a i).
pose T0 := take k (map val (enum (sees (team_of w) a i))).
have inG x : x \in T0 -> exists2 y : robot, y \in sees (team_of w) a i & x = y.
  by move/mem_take/mapP => [y]; rewrite mem_enum; exists y.
apply: (@check_sizesP k t _ T0 [::] [::] 0%N) h => //.
- by apply: take_uniq; rewrite map_inj_uniq ?enum_uniq //; apply: val_inj.
- by apply/allP => x /inG[y _ ->]; apply: ltn_ord.
- by rewrite size_takel // size_map -cardE.
by move=> x /inG[y yG ->]; rewrite robot_of_val.
Qed.
End Soundness.
