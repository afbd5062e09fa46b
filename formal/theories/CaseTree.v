(** The one kind of tree of lower proofs: cases by what each robot may be in a group. Generic in the value, and in what
    closes a case by budgets or by costs. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify ssrZ.
From Ratt Require Import Extrema Teams Graph.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** What a robot may be: in the group and not blinded, in the group and blinded, or not in the group. *)
Record option_set := Options { may_sense : bool; may_blind : bool; may_out : bool }.
Definition nothing : option_set := Options false false false.
Definition open (o : option_set) : bool := may_sense o && (may_blind o || may_out o).
Definition sure (o : option_set) : bool := may_sense o && ~~ (may_blind o || may_out o).
Definition inside (o : option_set) : bool := ~~ may_out o.
Definition gone (o : option_set) : bool := may_out o && ~~ (may_sense o || may_blind o).
Definition no_sense (o : option_set) : option_set := Options false (may_blind o) (may_out o).
Definition no_out (o : option_set) : option_set := Options (may_sense o) (may_blind o) false.
Definition only_sense : option_set := Options true false false.
Definition only_out : option_set := Options false false true.

(** Steps: a robot senses or not; is inside or not; each of these robots with those known is worth the claim; any [r + 1]
    open robots with those known are. Leaves: those known are worth the claim; any open robots that are missing with
    those known are; no group of the case exists; all cost too much; the case is one group, which is listed. *)
Inductive case_tree :=
| Sense of nat & case_tree & case_tree
| Inside of nat & case_tree & case_tree
| WorthEach of seq nat & case_tree
| AtMost of nat & case_tree
| IsWorth
| CopiesWorth
| NoBudget
| Dear of nat
| IsListed.

(** The information of the robots that sense for sure, how many they are, how many robots sense at most, all options. *)
Record case (S : Type) := Case { known : S; seen : nat; room : Z; options : seq option_set }.

Section Checker.
Variables (S : Type) (add : S -> nat -> S) (worth : S -> bool) (average_worth : S -> seq nat -> nat -> bool).
Variables (G : Type) (inner : bool) (least : Z).
Variables (budget : case S -> bool) (dear : nat -> case S -> bool) (note : case S -> option (option G)).

Definition options_of (c : case S) (i : nat) : option_set := nth nothing (options c) i.
Definition put (c : case S) (i : nat) (o : option_set) : case S :=
  Case (known c) (seen c) (room c) (set_nth nothing (options c) i o).
Definition join (c : case S) (i : nat) : case S :=
  Case (add (known c) i) (seen c).+1 (room c) (set_nth nothing (options c) i only_sense).
Definition bring (c : case S) (i : nat) : case S :=
  if may_blind (options_of c i) then put c i (no_out (options_of c i)) else join c i.
Definition drop_sense (c : case S) (i : nat) : case S := put c i (no_sense (options_of c i)).
Definition opens (c : case S) : seq nat := [seq i <- iota 0 (size (options c)) | open (options_of c i)].

(** Checks the case and adds what it lists to [found]. *)
Fixpoint check_cases (t : case_tree) (c : case S) (found : seq G) {struct t} : option (seq G) :=
  match t with
  | Sense i t1 t2 =>
      if open (options_of c i) then
        if check_cases t1 (join c i) found is Some f then check_cases t2 (drop_sense c i) f else None
      else None
  | Inside i t1 t2 =>
      let o := options_of c i in
      if [&& inner, may_out o & may_sense o || may_blind o] then
        if check_cases t1 (bring c i) found is Some f then check_cases t2 (put c i only_out) f else None
      else None
  | WorthEach s t' =>
      if sorted ltn s && all (fun i => open (options_of c i) && worth (add (known c) i)) s then
        check_cases t' (foldl drop_sense c s) found
      else None
  | AtMost r t' =>
      let left := opens c in
      if [&& Z.ltb (Z.add (Z.of_nat (seen c)) (Z.of_nat r)) (room c), (r < size left)%N & average_worth (known c) left r.+1] then
        check_cases t' (Case (known c) (seen c) (Z.add (Z.of_nat (seen c)) (Z.of_nat r)) (options c)) found
      else None
  | IsWorth => if worth (known c) then Some found else None
  | CopiesWorth =>
      let left := opens c in
      let r := Z.to_nat (Z.sub least (Z.of_nat (seen c))) in
      if [&& (0 < r)%N, (r <= size left)%N & average_worth (known c) left r] then Some found else None
  | NoBudget => if budget c then Some found else None
  | Dear k => if dear k c then Some found else None
  | IsListed =>
      match note c with
      | Some (Some g) => Some (g :: found)
      | Some None => Some found
      | None => None
      end
  end.

Definition count_inside (c : case S) : nat := count inside (options c).
Definition count_open (c : case S) : nat := count open (options c).
Definition count_open_inside (c : case S) : nat := count (fun o => open o && inside o) (options c).

(** More robots sense than may, or fewer than must. *)
Definition impossible (c : case S) : bool :=
  Z.ltb (room c) (Z.of_nat (seen c)) || Z.ltb (Z.of_nat (seen c + count_open c)) least.
(** Robots of the group that are blinded at least. *)
Definition fewest_blinded (c : case S) : Z :=
  Z.sub (Z.of_nat (count_inside c))
    (Z.add (Z.of_nat (seen c)) (Z.min (Z.sub (room c) (Z.of_nat (seen c))) (Z.of_nat (count_open_inside c)))).
End Checker.

(** ** Whether one group is one of a case *)
Section Group.
Local Open Scope ring_scope.
Variables (w : network) (S : Type) (start : S) (add : S -> nat -> S).
Local Notation robot := 'I_(top_robot w).+1.
Local Notation below := (fun i => (i < robots w)%N).
(** A group and blinded robots. *)
Variables (C B : {set robot}).

Definition sensing_size : nat := #|C :\: B|.
Definition may_be (o : option_set) (i : robot) : bool :=
  if i \in C then (if i \in B then may_blind o else may_sense o) else may_out o.

(** The group is one of the case. *)
Record stands (c : case S) : Prop := Stands {
  stands_known : exists T, [/\ known c = foldl add start T, uniq T, seen c = size T
    & forall i, (i \in T) = sure (options_of c i)];
  stands_size : size (options c) = robots w;
  stands_may : forall i : robot, may_be (options_of c i) i;
  stands_room : Z.le (Z.of_nat sensing_size) (room c)
}.

Section Counting.
Variable c : case S.
Hypothesis st : stands c.

Lemma below_options i : options_of c i <> nothing -> (i < robots w)%N.
Proof. by rewrite -(stands_size st) ltnNge => h; apply/negP => le; apply: h; rewrite /options_of nth_default. Qed.

Lemma open_below i : open (options_of c i) -> (i < robots w)%N.
Proof. by move=> h; apply: below_options => e; rewrite e in h. Qed.

Lemma sure_below i : sure (options_of c i) -> (i < robots w)%N.
Proof. by move=> h; apply: below_options => e; rewrite e in h. Qed.

Lemma may_at i : (i < robots w)%N -> may_be (options_of c i) (robot_of w i).
Proof. by move=> il; have := stands_may st (robot_of w i); rewrite robot_ofK. Qed.

Lemma sure_sensing i : sure (options_of c i) -> robot_of w i \in C :\: B.
Proof.
move=> h; have := may_at (sure_below h); move: h; rewrite /sure /may_be !inE.
by case: (options_of c i) => [] [] [] [] //=; case: (_ \in C); case: (_ \in B).
Qed.

Lemma sensing_known (i : robot) : i \in C :\: B -> sure (options_of c i) || open (options_of c i).
Proof.
have := stands_may st i; rewrite /sure /open /may_be !inE.
by case: (options_of c i) => [] [] [] [] //=; case: (_ \in C); case: (_ \in B).
Qed.

Lemma mem_opens i : (i \in opens c) = open (options_of c i).
Proof.
rewrite mem_filter mem_iota add0n (stands_size st) leq0n /=; case e: (open _) => //=.
exact: open_below.
Qed.

Lemma opens_uniq : uniq (opens c).
Proof. exact/filter_uniq/iota_uniq. Qed.

(** ** Rules that concern numbers alone *)
Lemma count_options (P : pred option_set) : count P (options c) = (\sum_(i : robot) P (options_of c i))%N.
Proof.
rewrite -sum1_count big_mkcond (big_nth nothing) (stands_size st) big_mkord; apply: eq_bigr => i _.
by rewrite /options_of; case: (P _).
Qed.

Lemma seenE : seen c = (\sum_(i : robot) sure (options_of c i))%N.
Proof.
have [T [_ uT -> TE]] := stands_known st; rewrite -count_options.
have -> : count sure (options c) = size [seq i <- iota 0 (robots w) | sure (options_of c i)].
  rewrite -(stands_size st) -[in LHS](mkseq_nth nothing (options c)) count_map size_filter.
  exact: eq_count.
apply: perm_size; apply: uniq_perm => //; first exact/filter_uniq/iota_uniq.
move=> i; rewrite mem_filter mem_iota add0n TE; case e: (sure _) => //=; exact/esym/sure_below.
Qed.

Lemma sum_mem (A : {set robot}) : #|A| = (\sum_(i : robot) (i \in A))%N.
Proof. by rewrite -sum1_card big_mkcond; apply: eq_bigr => i _; case: (_ \in A). Qed.

Lemma may_cases (i : robot) : [/\ (sure (options_of c i) <= (i \in C :\: B))%N,
    ((i \in C :\: B) <= sure (options_of c i) + open (options_of c i))%N
  & (inside (options_of c i) <=
     (i \in C :&: B) + (sure (options_of c i) + ((open (options_of c i) && inside (options_of c i)) && (i \in C :\: B))))%N].
Proof.
have := stands_may st i; rewrite /may_be /sure /open /inside !inE.
by case: (options_of c i) => [] [] [] [] //=; case: (_ \in C); case: (_ \in B).
Qed.

Lemma not_impossible least : Z.le least (Z.of_nat sensing_size) -> ~~ impossible least c.
Proof.
move=> leastP; have le1 : (seen c <= sensing_size)%N.
  by rewrite seenE /sensing_size sum_mem; apply: leq_sum => i _; have [] := may_cases i.
have le2 : (sensing_size <= seen c + count_open c)%N.
  rewrite seenE /count_open count_options /sensing_size sum_mem -big_split.
  by apply: leq_sum => i _; have [] := may_cases i.
have := stands_room st; rewrite /impossible; lia.
Qed.

Lemma open_sensing : (seen c + \sum_(i : robot) (open (options_of c i) && (i \in C :\: B)) <= sensing_size)%N.
Proof.
rewrite seenE /sensing_size sum_mem -big_split /=; apply: leq_sum => i _; have [h _ _] := may_cases i.
by move: h; rewrite /open /sure; case: (options_of c i) => [] [] [] []; case: (_ \in _).
Qed.

Lemma fewest_blindedP : Z.le (fewest_blinded c) (Z.of_nat #|C :&: B|).
Proof.
pose both := (\sum_(i : robot) ((open (options_of c i) && inside (options_of c i)) && (i \in C :\: B)))%N.
pose blind := #|C :&: B|.
have le1 : (count_inside c <= blind + (seen c + both))%N.
  rewrite seenE /count_inside count_options /blind sum_mem -!big_split /=.
  by apply: leq_sum => i _; have [] := may_cases i.
have le2 : (both <= count_open_inside c)%N.
  rewrite /both /count_open_inside (count_options (fun o => open o && inside o)); apply: leq_sum => i _.
  by case: (_ && inside _); case: (_ \in _).
have le3 : (seen c + both <= sensing_size)%N.
  apply: leq_trans open_sensing; rewrite leq_add2l; apply: leq_sum => i _.
  by case: (open _); case: (inside _); case: (_ \in _).
have := stands_room st; rewrite -/blind /fewest_blinded; lia.
Qed.
End Counting.

(** ** Children *)
Section Children.
Variable c : case S.
Hypothesis st : stands c.
Lemma stands_put i o : (i < robots w)%N -> ~~ sure (options_of c i) -> ~~ sure o -> may_be o (robot_of w i) ->
  stands (put c i o).
Proof.
move=> il ns no mo; case: (st) => [[T [kT uT sT TE]] sz may rm]; split=> //=.
- exists T; split=> // j; rewrite /options_of nth_set_nth /=; case: eqP => [->|_]; last exact: TE.
  by rewrite TE (negbTE ns) (negbTE no).
- by rewrite size_set_nth sz; apply/maxn_idPr.
move=> j; rewrite /options_of nth_set_nth /=; case: eqP => [e|_]; last exact: may.
by rewrite -e robot_of_val in mo.
Qed.

Lemma stands_join i : (i < robots w)%N -> ~~ sure (options_of c i) -> robot_of w i \in C :\: B -> stands (join add c i).
Proof.
move=> il ns iV; case: (st) => [[T [kT uT sT TE]] sz may rm]; split=> //=.
- exists (rcons T i); rewrite -cats1 foldl_cat -kT cats1 rcons_uniq size_rcons sT uT TE ns; split=> // j.
  rewrite mem_rcons in_cons /options_of nth_set_nth /=; by case: eqP => //= _; rewrite TE.
- by rewrite size_set_nth sz; apply/maxn_idPr.
move=> j; rewrite /options_of nth_set_nth /=; case: eqP => [e|_]; last exact: may.
by move: iV; rewrite -e robot_of_val /may_be !inE => /andP[/negbTE-> ->].
Qed.

Lemma open_not_sure i : open (options_of c i) -> ~~ sure (options_of c i).
Proof. by rewrite /open /sure; case: (options_of c i) => [] [] [] []. Qed.
End Children.

Lemma stands_drop c i : stands c -> open (options_of c i) -> robot_of w i \notin C :\: B -> stands (drop_sense c i).
Proof.
move=> st oi iV; have il := open_below st oi; apply: stands_put => //; first exact: open_not_sure oi.
have := may_at st il; move: iV; rewrite /may_be !inE.
by case: (options_of c i) => [] [] [] [] //=; case: (_ \in C); case: (_ \in B).
Qed.

Lemma options_drop (c : case S) i j : i != j -> options_of (drop_sense c i) j = options_of c j.
Proof. by move=> ij; rewrite /options_of nth_set_nth /= eq_sym (negbTE ij). Qed.

Lemma stands_drops s c : uniq s -> stands c -> all (fun i => open (options_of c i)) s ->
  (forall i, i \in s -> robot_of w i \notin C :\: B) -> stands (foldl (@drop_sense S) c s).
Proof.
elim: s c => [//|i s IH] c /= /andP[iS us] st /andP[oi os] no; apply: IH => //.
- by apply: stands_drop => //; apply: no; rewrite mem_head.
- apply/allP => j js; rewrite options_drop; first exact: (allP os).
  by apply: contraNneq iS => ->.
by move=> j js; apply: no; rewrite in_cons js orbT.
Qed.

End Group.

(** ** What an accepted tree says about one group *)
Section Soundness.
Local Open Scope ring_scope.
Variables (w : network) (S : Type) (start : S) (add : S -> nat -> S) (worth : S -> bool).
Variable (average_worth : S -> seq nat -> nat -> bool).
Local Notation robot := 'I_(top_robot w).+1.
Local Notation element := 'I_(top_element w).+1.
Local Notation below := (fun i => (i < robots w)%N).
Variables (F : realFieldType) (phi : {set element} -> F) (p : {ffun robot -> element}) (lower : F).

Hypothesis worthP : forall T, uniq T -> all below T -> worth (foldl add start T) ->
  forall G : {set robot}, (forall i, i \in T -> robot_of w i \in G) -> lower <= phi (contributed p G).
Hypothesis averageP : forall T rest r, uniq T -> all below T -> (0 < r)%N -> average_worth (foldl add start T) rest r ->
  forall (T' : seq nat) (G : {set robot}), uniq (T ++ T') -> all below T' -> {subset T' <= rest} -> size T' = r ->
  (forall i, i \in T ++ T' -> robot_of w i \in G) -> lower <= phi (contributed p G).

(** The robots of the group that are not blinded are in [V]. *)
Variables (C B V : {set robot}).
Hypothesis sensing : C :\: B \subset V.
Local Notation stands := (stands start add C B).
Local Notation sensing_size := (sensing_size C B).

Section Values.
Variable c : case S.
Hypothesis st : stands c.

(** The robots that sense are those known to, and open ones. *)
Lemma missing_sensing (T : seq nat) r : (forall i, (i \in T) = sure (options_of c i)) -> uniq T ->
  (size T + r <= sensing_size)%N -> exists T', [/\ uniq (T ++ T'), all below T', {subset T' <= opens c}, size T' = r
    & forall i, i \in T ++ T' -> robot_of w i \in V].
Proof.
move=> TE uT le; pose rest := [seq i <- opens c | robot_of w i \in C :\: B].
have enough : (r <= size rest)%N.
  rewrite -(leq_add2l (size T)); apply: leq_trans le _.
  rewrite -size_cat /sensing_size cardE -(size_map (@nat_of_ord _)); apply: uniq_leq_size.
    by rewrite map_inj_uniq ?enum_uniq //; apply: val_inj.
  move=> x /mapP[i]; rewrite mem_enum => iV ->; rewrite mem_cat mem_filter robot_of_val iV /= (mem_opens st) TE.
  exact: (sensing_known st).
exists (take r rest); have sub x : x \in take r rest -> x \in rest by apply: mem_take.
have apart x : x \in take r rest -> x \notin T.
  by move/sub; rewrite mem_filter (mem_opens st) TE => /andP[_]; rewrite /sure /open; case: (options_of c x) => [] [] [] [].
split.
- rewrite cat_uniq uT (take_uniq _ (filter_uniq _ (opens_uniq c))) andbT /=.
  by apply/hasP => -[x /apart]; move/negbTE => /= ->.
- by apply/allP => x /sub; rewrite mem_filter (mem_opens st) => /andP[_]; apply: (open_below st).
- by move=> x /sub; rewrite mem_filter => /andP[].
- by rewrite size_takel.
move=> x; rewrite mem_cat => h; apply: (subsetP sensing); case/orP: h => [|/sub]; first by rewrite TE; apply: (sure_sensing st).
by rewrite mem_filter => /andP[].
Qed.

Lemma all_below (T : seq nat) : (forall i, (i \in T) = sure (options_of c i)) -> all below T.
Proof. by move=> TE; apply/allP => i; rewrite TE; apply: (sure_below st). Qed.

Lemma known_worth : worth (known c) -> lower <= phi (contributed p V).
Proof.
have [T [-> uT _ TE]] := stands_known st; move=> h; apply: worthP uT (all_below TE) h _ _ => i.
by rewrite TE => /(sure_sensing st); apply: (subsetP sensing).
Qed.

Lemma open_worth i : open (options_of c i) -> worth (add (known c) i) -> robot_of w i \in C :\: B ->
  lower <= phi (contributed p V).
Proof.
have [T [-> uT _ TE]] := stands_known st; move=> oi h iV; have il := open_below st oi.
have iT : i \notin T by rewrite TE; move: oi; rewrite /open /sure; case: (options_of c i) => [] [] [] [].
apply: (@worthP (rcons T i)); rewrite ?rcons_uniq ?iT //.
- by rewrite all_rcons il all_below.
- by rewrite -cats1 foldl_cat.
move=> j; rewrite mem_rcons in_cons => /orP[/eqP->|]; first exact: (subsetP sensing).
by rewrite TE => /(sure_sensing st); apply: (subsetP sensing).
Qed.

Lemma copies_worth r : (0 < r)%N -> average_worth (known c) (opens c) r -> (seen c + r <= sensing_size)%N ->
  lower <= phi (contributed p V).
Proof.
have [T [-> uT -> TE]] := stands_known st; move=> r0 h le.
have [T' [u b sub sz TV]] := missing_sensing TE uT le.
exact: averageP uT (all_below TE) r0 h _ _ u b sub sz TV.
Qed.

End Values.

(** ** The tree *)
Variables (G : eqType) (inner : bool) (least : Z).
Variables (budget : case S -> bool) (dear : nat -> case S -> bool) (note : case S -> option (option G)).
Variables (is_dear : Prop) (fits : G -> Prop).
Local Notation check := (check_cases add worth average_worth inner least budget dear note).
Hypotheses (leastP : Z.le least (Z.of_nat sensing_size)) (budgetP : forall c, stands c -> ~~ budget c)
  (dearP : forall k c, stands c -> dear k c -> is_dear)
  (noteP : forall c g, stands c -> note c = Some g -> is_dear \/ exists2 h, g = Some h & fits h).

Lemma check_keeps t c found f : check t c found = Some f -> {subset found <= f}.
Proof.
elim: t c found f => [i t1 IH1 t2 IH2|i t1 IH1 t2 IH2|s t IH|r t IH||||k|] c found f /=.
- case: ifP => // _; case e: (check t1 _ _) => [f1|//] h x /(IH1 _ _ _ e); exact: IH2 h x.
- case: ifP => // _; case e: (check t1 _ _) => [f1|//] h x /(IH1 _ _ _ e); exact: IH2 h x.
- by case: ifP => // _; apply: IH.
- by case: ifP => // _; apply: IH.
- by case: ifP => // _ [->].
- by case: ifP => // _ [->].
- by case: ifP => // _ [->].
- by case: ifP => // _ [->].
by case: (note c) => [[g|]|] // [<-] // x xf; rewrite in_cons xf orbT.
Qed.

Theorem check_casesP t c found f : check t c found = Some f -> stands c ->
  lower <= phi (contributed p V) \/ is_dear \/ (exists2 g, g \in f & fits g).
Proof.
have later t' c' f1 f2 : check t' c' f1 = Some f2 ->
    lower <= phi (contributed p V) \/ is_dear \/ (exists2 g, g \in f1 & fits g) ->
    lower <= phi (contributed p V) \/ is_dear \/ (exists2 g, g \in f2 & fits g).
  move=> /check_keeps sub [h|[h|[g gf h]]]; [by left|by right; left|right; right; exists g => //; exact: sub].
elim: t c found f => [i t1 IH1 t2 IH2|i t1 IH1 t2 IH2|s t IH|r t IH||||k|] c found f /=.
- case: ifP => // oi; case e: (check t1 _ _) => [f1|//] h st.
  have [iV|iV] := boolP (robot_of w i \in C :\: B); last by apply: IH2 h _; apply: (stands_drop st).
  apply: later h _; apply: IH1 e _; exact: (stands_join st (open_below st oi) (open_not_sure oi) iV).
- case: ifP => // /and3P[_ oo os]; case e: (check t1 _ _) => [f1|//] h st.
  have il : (i < robots w)%N by apply: (below_options st) => e'; rewrite e' in oo.
  have ns : ~~ sure (options_of c i) by rewrite /sure oo orbT andbF.
  have mi := may_at st il.
  have [iC|iC] := boolP (robot_of w i \in C); last first.
    by apply: IH2 h _; apply: (stands_put st) => //; rewrite /may_be (negbTE iC).
  apply: later h _; apply: IH1 e _; rewrite /bring; case: ifP => mb; last first.
    by apply: (stands_join st) => //; move: mi; rewrite /may_be iC !inE iC mb; case: (_ \in B).
  apply: (stands_put st) => //; first by rewrite /sure /= mb andbF.
  by move: mi; rewrite /may_be iC.
- case: ifP => // /andP[so al] h st.
  have us : uniq s by apply: sorted_uniq so; [exact: ltn_trans | exact: ltnn].
  have [/hasP[i iS iV]|no] := boolP (has (fun i => robot_of w i \in C :\: B) s).
    by have /andP[oi wi] := allP al i iS; left; apply: (open_worth st oi wi iV).
  apply: IH h _; apply: (stands_drops us st) => //; first by apply/allP => i /(allP al)/andP[].
  by move=> i iS; apply: contra no => iV; apply/hasP; exists i.
- case: ifP => // /and3P[lt rl av] h st.
  have [few|many] := leqP sensing_size (seen c + r).
    apply: IH h _; case: (st) => k sz may rm; split=> //=. lia.
  by left; apply: (copies_worth st _ av) => //; rewrite addnS.
- by case: ifP => // h _ st; left; apply: (known_worth st h).
- case: ifP => // /and3P[r0 rl av] _ st; left; apply: (copies_worth st _ av) => //; have := leastP; lia.
- by case: ifP => // h _ st; have := budgetP st; rewrite h.
- by case: ifP => // h _ st; right; left; apply: dearP st h.
case e: (note c) => [[g|]|] // [<-] st; right; have [d|[h]] := noteP st e; [by left| |by left|by []].
by case=> <- fh; right; exists g; rewrite ?mem_head.
Qed.

End Soundness.
