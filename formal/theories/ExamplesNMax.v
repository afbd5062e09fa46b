(** The smallest possible largest group on the networks of [Examples]; tests/formal/test_definitions.py compares. *)
From mathcomp Require Import all_ssreflect.
From Ratt Require Import Teams Graph NMax Sublists Examples.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.

Section Lists.
Variable w : network.
Hypothesis ok : network_ok w.

Definition component (ls : seq link) (i : nat) : seq nat :=
  [seq j <- iota 0 (robots w) | j \in reach (fun k => nth [::] (left_near w ([::], ls)) k) (robots w) [::] i].

Lemma card_component ls i : attack_ok w ([::], ls) -> (i < robots w)%N ->
  #|group (team_of w) (set0, links_of w ls) (robot_of w i)| = size (component ls i).
Proof.
move=> oka il; have [_ e _] := @exact_group w ([::], ls) (robot_of w i) (component ls i) _ ok oka
  (congr1 (fun k => [seq j <- iota 0 (robots w) | j \in reach _ _ _ k]) (robot_ofK il)) erefl.
have e0 : attack_of w ([::], ls) = (set0, links_of w ls).
  by congr pair; apply/setP => j; rewrite !inE.
rewrite -e0 e -(size_map (robot_of w)) -(card_uniqP _).
  apply: eq_card => j; rewrite !inE; apply/idP/mapP => [jc|[k kc ->]]; first by exists (j : nat); rewrite ?robot_of_val.
  by rewrite robot_ofK //; move: kc; rewrite mem_filter mem_iota add0n => /andP[_].
rewrite map_inj_in_uniq ?filter_uniq ?iota_uniq // => a b.
rewrite !mem_filter !mem_iota !add0n => /andP[_ al] /andP[_ bl] /(congr1 (@nat_of_ord _)).
by rewrite !robot_ofK.
Qed.

Lemma n_max_at_most k ls : attack_ok w ([::], ls) -> all (fun i => size (component ls i) <= k)%N (iota 0 (robots w)) ->
  (n_max (team_of w) <= k)%N.
Proof.
move=> oka /allP h; have al := attack_of_allowed ok oka.
have e0 : attack_of w ([::], ls) = (set0, links_of w ls) by congr pair; apply/setP => j; rewrite !inE.
rewrite e0 in al; apply: leq_trans (n_max_le al) _; apply/bigmax_leqP => i _.
by rewrite -(robot_of_val i) card_component // h // mem_iota add0n ltn_ord.
Qed.

Lemma n_max_at_least k : (k <= robots w)%N ->
  all (fun ls => attack_ok w ([::], ls) ==> has (fun i => k <= size (component ls i))%N (iota 0 (robots w)))
    (parts (link_list w)) -> (k <= n_max (team_of w))%N.
Proof.
move=> kR /allP h; apply: le_n_max; first by rewrite card_ord.
move=> C /and5P[_ cb sub _ safe].
pose ls := [seq l <- link_list w | link_of w l \in C].
have lsE : links_of w ls = C.
  apply/setP => c; rewrite inE; apply/mapP/idP => [[l]|cC]; first by rewrite mem_filter => /andP[lC _] ->.
  have := subsetP sub _ cC; rewrite inE => /mapP[l ll e]; exists l => //.
  by rewrite mem_filter -e cC.
have oka : attack_ok w ([::], ls).
  have inj : {in link_list w &, injective (link_of w)}.
    move=> a b /(allP (links_ok ok)) ha /(allP (links_ok ok)) hb; exact: link_of_inj.
  have us : uniq ls by rewrite filter_uniq // links_uniq.
  have szC : size ls = #|C|.
    rewrite -lsE -(size_map (link_of w)) -(card_uniqP _); first by apply: eq_card => c; rewrite !inE.
    rewrite map_inj_in_uniq // => a b; rewrite !mem_filter => /andP[_ ha] /andP[_ hb]; exact: inj.
  apply/and4P; split=> //; first by rewrite szC.
  apply/allP => l; rewrite mem_filter => /andP[lC -> /=]; apply/negP => lk.
  by have := disjointFr safe lC; rewrite /= inE map_f.
have /implyP/(_ oka)/hasP[i] := h ls (filter_parts _ _).
rewrite mem_iota add0n => il le; apply: leq_trans le _; rewrite -(card_component oka il) lsE.
exact: (@leq_bigmax _ (fun i => #|group (team_of w) (set0, C) i|) (robot_of w i)).
Qed.
End Lists.

(** A line of three and a line of four robots, a triangle with a protected link. *)
Definition relay_n_max : nat := 3.
Definition safe_n_max : nat := 2.
Definition split_n_max : nat := 2.

Theorem n_max_values : [/\ n_max (team_of relay_net) = relay_n_max, n_max (team_of safe_net) = safe_n_max
  & n_max (team_of split_net) = split_n_max].
Proof.
split; apply/eqP; rewrite eqn_leq.
- by rewrite (@n_max_at_most _ _ _ [::]) ?(@n_max_at_least _ _ 3) //; vm_compute.
- by rewrite (@n_max_at_most _ _ _ [:: (0, 2)%N; (1, 2)%N]) ?(@n_max_at_least _ _ 2) //; vm_compute.
by rewrite (@n_max_at_most _ _ _ [:: (1, 2)%N]) ?(@n_max_at_least _ _ 2) //; vm_compute.
Qed.
