(** The executable side of teams and attacks: robots and links as numbers, groups by search, and what they mean. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify.
From Ratt Require Import Extrema Teams.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.

Definition link := (nat * nat)%type.

(** The graph, the owners and the budgets of a problem; robots are [0 .. top_robot]. *)
Record network := Network {
  top_robot : nat;
  owners : seq nat;
  link_list : seq link;
  blind_budget : nat;
  cut_budget : nat;
  kept_robots : seq nat;
  kept_links : seq link
}.
Definition robots (w : network) : nat := (top_robot w).+1.
Definition top_element (w : network) : nat := (size (owners w)).-1.

Definition link_ok (n : nat) (l : link) : bool := (l.1 < l.2 < n)%N.
Definition network_ok (w : network) : bool :=
  [&& (0 < size (owners w))%N, all (fun i => i < robots w)%N (owners w),
      all (fun i => i \in owners w) (iota 0 (robots w)),
      all (link_ok (robots w)) (link_list w), uniq (link_list w),
      all (link_ok (robots w)) (kept_links w), all (fun l => l \in link_list w) (kept_links w)
    & all (fun i => i < robots w)%N (kept_robots w)].

Definition neighbours (ls : seq link) (i : nat) : seq nat :=
  [seq l.2 | l <- ls & l.1 == i] ++ [seq l.1 | l <- ls & l.2 == i].

(** An attack as listed in a certificate: blinded robots and cut links. *)
Definition listed_attack := (seq nat * seq link)%type.
Definition attack_ok (w : network) (a : listed_attack) : bool :=
  [&& (size a.1 <= blind_budget w)%N, all (fun i => (i < robots w)%N && (i \notin kept_robots w)) a.1,
      (size a.2 <= cut_budget w)%N & all (fun l => (l \in link_list w) && (l \notin kept_links w)) a.2].

(** Depth-first search, as in MathComp's [dfs] but on numbers. *)
Fixpoint reach (g : nat -> seq nat) (fuel : nat) (v : seq nat) (x : nat) : seq nat :=
  if x \in v then v else if fuel is k.+1 then foldl (reach g k) (x :: v) (g x) else v.

Definition left_near (w : network) (a : listed_attack) : seq (seq nat) :=
  let left := [seq l <- link_list w | l \notin a.2] in
  [seq neighbours left i | i <- iota 0 (robots w)].

(** Robots that see of the groups that have one, in the order of their lowest; one empty group if none sees. *)
Definition add_group (n : nat) (near : seq (seq nat)) (blind : seq nat) (found : seq (seq nat)) (i : nat) :=
  if (i \in blind) || has (fun g => i \in g) found then found
  else rcons found [seq j <- reach (fun k => nth [::] near k) n [::] i | j \notin blind].
Definition seeing_groups (w : network) (a : listed_attack) : seq (seq nat) :=
  let near := left_near w a in
  let found := foldl (add_group (robots w) near a.1) [::] (iota 0 (robots w)) in
  if found is [::] then [:: [::]] else found.

Section Meaning.
Variable w : network.
Local Notation robot := 'I_(top_robot w).+1.
Local Notation element := 'I_(top_element w).+1.

Definition robot_of (i : nat) : robot := inord i.
Definition link_of (l : link) : {set robot} := [set robot_of l.1; robot_of l.2].
Definition links_of (ls : seq link) : {set {set robot}} := [set l in map link_of ls].
Definition set_of (s : seq nat) : {set robot} := [set i : robot | (i : nat) \in s].

(** The team that the numbers stand for. *)
Definition team_of : team [finType of robot] [finType of element] :=
  Team (fun e : element => robot_of (nth 0 (owners w) e)) (links_of (link_list w)) (blind_budget w) (cut_budget w)
       (set_of (kept_robots w)) (links_of (kept_links w)).
Definition attack_of (a : listed_attack) : attack [finType of robot] := (set_of a.1, links_of a.2).

Definition linkmem (ls : seq link) (i j : nat) : bool := ((i, j) \in ls) || ((j, i) \in ls).

Lemma pair_eq (i j a b : robot) : i != j -> a != b ->
  ([set i; j] == [set a; b]) = ((i == a) && (j == b)) || ((i == b) && (j == a)).
Proof.
move=> ij ab; apply/eqP/idP => [/setP e|]; last first.
  by case/orP=> /andP[/eqP-> /eqP->] //; apply/setP => k; rewrite !inE orbC.
have /set2P ji : j \in [set a; b] by rewrite -e !inE eqxx orbT.
have /set2P ii : i \in [set a; b] by rewrite -e !inE eqxx.
case: ii ji ij => -> [] ->; rewrite ?eqxx ?orbT //.
Qed.

Lemma robot_ofK i : (i < robots w)%N -> robot_of i = i :> nat.
Proof. exact: inordK. Qed.

Lemma robot_of_val (i : robot) : robot_of i = i.
Proof. exact: inord_val. Qed.

Lemma link_of_inj l m : link_ok (robots w) l -> link_ok (robots w) m -> link_of l = link_of m -> l = m.
Proof.
case: l m => [a b] [c e]; rewrite /link_ok /link_of /= => /andP[ab bn] /andP[ce en] /eqP.
have an := ltn_trans ab bn; have cn := ltn_trans ce en.
rewrite pair_eq; [|by rewrite -val_eqE /= !robot_ofK // ltn_eqF..].
rewrite -!val_eqE /= !robot_ofK // => /orP[/andP[/eqP-> /eqP->] //|/andP[/eqP ea /eqP eb]].
by move: ab ce; rewrite ea eb => h1 h2; have := ltn_trans h1 h2; rewrite ltnn.
Qed.

Lemma mem_links_of ls (i j : robot) : all (link_ok (robots w)) ls -> i != j ->
  ([set i; j] \in links_of ls) = linkmem ls i j.
Proof.
move=> /allP ok ij; rewrite inE; apply/mapP/orP => [[[a b] abls e]|].
  have := ok _ abls; rewrite /link_ok /= => /andP[ab bn]; have an := ltn_trans ab bn.
  move/eqP: e; rewrite /link_of pair_eq //; last by rewrite -val_eqE /= !robot_ofK // ltn_eqF.
  rewrite -!val_eqE /= !robot_ofK // => /orP[/andP[/eqP-> /eqP->]|/andP[/eqP-> /eqP->]]; first by left.
  by right.
case=> h; [exists ((i : nat), (j : nat)) | exists ((j : nat), (i : nat))] => //=.
  by rewrite /link_of /= !robot_of_val.
by rewrite /link_of /= !robot_of_val setUC.
Qed.

Lemma mem_neighbours ls i j : (j \in neighbours ls i) = linkmem ls i j.
Proof.
rewrite /neighbours mem_cat; congr (_ || _); apply/mapP/idP => [[[a b]]|h].
- by rewrite mem_filter /= => /andP[/eqP-> h] ->.
- by exists (i, j); rewrite ?mem_filter ?eqxx.
- by rewrite mem_filter /= => /andP[/eqP-> h] ->.
- by exists (j, i); rewrite ?mem_filter ?eqxx.
Qed.

Hypothesis ok : network_ok w.

Lemma links_ok : all (link_ok (robots w)) (link_list w).
Proof. by case/and4P: ok => _ _ _ /andP[]. Qed.
Lemma kept_links_ok : all (link_ok (robots w)) (kept_links w).
Proof. by case/and4P: ok => _ _ _ /and4P[]. Qed.
Lemma links_uniq : uniq (link_list w).
Proof. by case/and4P: ok => _ _ _ /and3P[]. Qed.

Lemma cut_ok a : attack_ok w a -> all (link_ok (robots w)) a.2.
Proof.
case/and4P=> _ _ _ /allP h; apply/allP => l /h /andP[lw _].
by have /allP := links_ok; apply.
Qed.

Lemma card_set_of s : (#|set_of s| <= size s)%N.
Proof.
rewrite cardE -(size_map val); apply: uniq_leq_size; first by rewrite map_inj_uniq ?enum_uniq //; apply: val_inj.
by move=> x /mapP[i]; rewrite mem_enum inE => h ->.
Qed.

Lemma card_links_of ls : (#|links_of ls| <= size ls)%N.
Proof.
rewrite cardE -(size_map link_of); apply: uniq_leq_size; first exact: enum_uniq.
by move=> x; rewrite mem_enum inE.
Qed.

Lemma attack_of_allowed a : attack_ok w a -> allowed team_of (attack_of a).
Proof.
move=> oka; have cok := cut_ok oka; case/and4P: oka => sb /allP rb scut /allP lb.
rewrite /allowed /= (leq_trans (card_set_of _) sb) (leq_trans (card_links_of _) scut) /=; apply/and3P; split.
- apply/subsetP => l; rewrite !inE => /mapP[m ma ->]; apply: map_f; by case/andP: (lb m ma).
- rewrite disjoint_subset; apply/subsetP => i; rewrite !inE => /rb /andP[_]. by [].
rewrite disjoint_subset; apply/subsetP => l; rewrite !inE => /mapP[m ma ->].
apply/mapP => -[m' m'k e]; have /allP kok := kept_links_ok; have /allP aok := cok.
have := link_of_inj (aok _ ma) (kok _ m'k) e => e'; move: (lb m ma); by rewrite e' m'k andbF.
Qed.

Lemma mem_left_near a (i j : robot) : attack_ok w a ->
  ((j : nat) \in nth [::] (left_near w a) i) = linked team_of (attack_of a) i j.
Proof.
move=> oka; rewrite /left_near (nth_map 0) ?size_iota ?ltn_ord // nth_iota ?ltn_ord // add0n mem_neighbours.
rewrite /linked /linkmem !mem_filter; have [<-|ij] := eqVneq i j.
  apply/negP => /orP[] /andP[_ h]; have /allP/(_ _ h) := links_ok; by rewrite /link_ok /= ltnn.
rewrite in_setD /cut /= !mem_links_of ?links_ok ?cut_ok // /linkmem /=.
have anti (k l : nat) : (k, l) \in link_list w -> (l, k) \notin a.2.
  move=> h1; apply/negP => h2; have /allP/(_ _ h1) := links_ok; have /allP/(_ _ h2) := cut_ok oka.
  by rewrite /link_ok /= => /andP[h3 _] /andP[h4 _]; have := ltn_trans h3 h4; rewrite ltnn.
case h1: (_ \in link_list w); case h2: (_ \in link_list w); rewrite ?andbT ?andbF ?orbF //=.
- by have /allP/(_ _ h1) := links_ok; have /allP/(_ _ h2) := links_ok; rewrite /link_ok /=;
     move=> /andP[h3 _] /andP[h4 _]; have := ltn_trans h3 h4; rewrite ltnn.
- by rewrite (negbTE (anti _ _ h1)) orbF.
by rewrite (negbTE (anti _ _ h2)).
Qed.

(** Search finds the connected component. *)
Lemma reach_dfs (g : nat -> seq nat) (h : robot -> seq robot) k v x :
  (forall y : robot, map val (h y) = [seq z <- g y | (z < robots w)%N]) ->
  (forall y : robot, all (fun z => z < robots w)%N (g y)) ->
  reach g k (map val v) (val x) = map val (dfs h k v x).
Proof.
move=> hg lt; have eqg (y : robot) : g y = map val (h y) by rewrite hg; apply/esym/all_filterP/lt.
elim: k v x => [|k IH] v x /=; first by rewrite mem_map ?if_same //; apply: val_inj.
rewrite mem_map; last exact: val_inj.
case: ifP => // _; rewrite eqg -[val x :: map val v]/(map val (x :: v)).
by elim: (h x) (x :: v) => [//|y s IHs] v' /=; rewrite IH IHs.
Qed.

Lemma near_lt a (i : robot) : all (fun z => z < robots w)%N (nth [::] (left_near w a) i).
Proof.
rewrite /left_near (nth_map 0) ?size_iota ?ltn_ord // nth_iota ?ltn_ord // add0n; apply/allP => j.
rewrite mem_neighbours /linkmem !mem_filter => /orP[] /andP[_ h]; have /allP/(_ _ h) := links_ok; rewrite /link_ok /=.
  by case/andP.
by case/andP => h1 h2; apply: ltn_trans h1 h2.
Qed.

Lemma mem_reach a (i j : robot) : attack_ok w a ->
  ((j : nat) \in reach (fun k => nth [::] (left_near w a) k) (robots w) [::] i) =
  connect (linked team_of (attack_of a)) i j.
Proof.
move=> oka; set g := fun k => _; pose h (y : robot) := map robot_of (g y).
have lt := near_lt a.
have hg (y : robot) : map val (h y) = [seq z <- g y | (z < robots w)%N].
  rewrite (all_filterP (lt y)) /h -map_comp -[RHS]map_id; apply/eq_in_map => z zy /=.
  by rewrite robot_ofK //; move/allP: (lt y); apply.
have eqr : reach g (robots w) [::] i = map val (dfs h (robots w) [::] i) := reach_dfs (robots w) [::] i hg lt.
rewrite eqr mem_map; last exact: val_inj.
have -> : robots w = #|robot| by rewrite card_ord.
have e : grel h =2 linked team_of (attack_of a).
  move=> x y; rewrite /= -(mem_left_near x y oka) -/(g x).
  apply/mapP/idP => [[z zx ->]|yx]; last by exists (y : nat); rewrite ?robot_of_val.
  by rewrite robot_ofK //; move/allP: (lt x); apply.
rewrite -(eq_connect e); apply/dfsP/connectP => -[p pth lst]; by exists p.
Qed.

Lemma seeing_groupsP a (i : robot) : attack_ok w a -> sees team_of (attack_of a) i != set0 ->
  exists2 g, g \in seeing_groups w a & sees team_of (attack_of a) i = set_of g.
Proof.
move=> oka /set0Pn[j]; rewrite !inE => /andP[jb ij].
rewrite /seeing_groups; set near := left_near w a.
set add := add_group _ _ _.
pose good (found : seq (seq nat)) := forall g, g \in found -> exists2 k : robot, (k : nat) \notin a.1 &
  g = [seq l <- reach (fun k => nth [::] near k) (robots w) [::] k | l \notin a.1].
have step (found : seq (seq nat)) (s : seq nat) : good found -> (forall k, k \in s -> (k < robots w)%N) ->
    good (foldl add found s) /\ (forall k, k \in s -> k \notin a.1 -> has (fun g => k \in g) (foldl add found s))
    /\ (forall k, has (fun g => k \in g) found -> has (fun g => k \in g) (foldl add found s)).
  elim: s found => [|k s IH] found gf lt //=.
  have kn : (k < robots w)%N by apply: lt; rewrite mem_head.
  have gadd : good (add found k).
    rewrite /add /add_group; case: ifP => // /norP[kb _] g; rewrite mem_rcons in_cons => /orP[/eqP->|/gf //].
    by exists (robot_of k); rewrite robot_ofK.
  have mono l : has (fun g => l \in g) found -> has (fun g => l \in g) (add found k).
    by rewrite /add /add_group; case: ifP => // _; rewrite has_rcons => ->; rewrite orbT.
  have lt' l : l \in s -> (l < robots w)%N by move=> ls; apply: lt; rewrite in_cons ls orbT.
  have [h1 [h2 h3]] := IH _ gadd lt'.
  split=> //; split=> [l|l /mono]; last exact: h3.
  rewrite in_cons => /orP[/eqP->|/h2 //] kb; apply: h3; rewrite /add /add_group.
  case: ifP => [/orP[kb'|//]|]; first by rewrite kb' in kb.
  move=> _; rewrite has_rcons mem_filter kb /=.
  rewrite -(robot_ofK kn) mem_reach // connect0 //.
have io k : k \in iota 0 (robots w) -> (k < robots w)%N by rewrite mem_iota add0n.
have g0 : good [::] by [].
have [gall [hall _]] := step _ _ g0 io; have := hall j; rewrite mem_iota add0n ltn_ord => /(_ isT jb) /hasP[g gin jg].
exists g; first by case: (foldl _ _ _) gin.
have [k kb eg] := gall _ gin; move: jg; rewrite eg mem_filter mem_reach // => /andP[_ kj].
have cs := connect_linked_sym team_of (attack_of a).
apply/setP => l; rewrite !inE mem_filter mem_reach //; case: (_ \notin _) => //=.
have kc : connect (linked team_of (attack_of a)) i k by apply: connect_trans ij _; rewrite cs.
by rewrite (same_connect cs kc).
Qed.
End Meaning.
