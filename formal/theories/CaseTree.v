(** The one kind of tree of lower proofs: cases by what each robot may be in a group. Generic in the value, and in what
    closes a case by budgets or by costs. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify ssrZ.
From Ratt Require Import Extrema Teams Graph Worth.
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

(** Branches: a robot senses or not; is inside or not; at least [k] robots sense, or fewer; fewer than [b] robots are
    blinded, or at least [b]. What a limit says of the case goes on in one child. Leaves: those known to sense are worth the claim; any open robots that are missing with
    those known are; no group of the case exists; all cost too much; the case is one group, which is listed. *)
Inductive case_tree :=
| Sense of nat & case_tree & case_tree
| Inside of nat & case_tree & case_tree
| Sensing of nat & case_tree & case_tree
| Blinding of nat & case_tree & case_tree
| Limited of nat & case_tree
| IsWorth
| CopiesWorth
| NoBudget
| Dear of nat
| IsListed.

(** The information of the robots that sense for sure, and how many they are; [least] to [most] robots sense, [low] to
    [high] robots are blinded; the options of all robots. *)
Record case (S : Type) := Case {
  known : S; seen : nat; least : Z; most : Z; low : Z; high : Z; options : seq option_set
}.

Section Checker.
Variables (S : Type) (add : S -> nat -> S) (worth : S -> bool) (average_worth : S -> seq nat -> nat -> bool).
Variables (G : Type) (narrow : nat -> case S -> option (case S)).
Variables (budget : case S -> bool) (dear : nat -> case S -> bool) (note : case S -> option (option G)).

Definition options_of (c : case S) (i : nat) : option_set := nth nothing (options c) i.
Definition put (c : case S) (i : nat) (o : option_set) : case S :=
  Case (known c) (seen c) (least c) (most c) (low c) (high c) (set_nth nothing (options c) i o).
Definition join (c : case S) (i : nat) : case S :=
  Case (add (known c) i) (seen c).+1 (least c) (most c) (low c) (high c) (set_nth nothing (options c) i only_sense).
Definition bring (c : case S) (i : nat) : case S :=
  if may_blind (options_of c i) then put c i (no_out (options_of c i)) else join c i.
Definition drop_sense (c : case S) (i : nat) : case S := put c i (no_sense (options_of c i)).
Definition with_sensing (c : case S) (a b : Z) : case S := Case (known c) (seen c) a b (low c) (high c) (options c).
Definition with_blinded (c : case S) (a b : Z) : case S := Case (known c) (seen c) (least c) (most c) a b (options c).

Definition open_inside (o : option_set) : bool := open o && inside o.
Definition robots_that (P : pred option_set) (c : case S) : seq nat :=
  [seq i <- iota 0 (size (options c)) | P (options_of c i)].
Definition count_inside (c : case S) : nat := count inside (options c).

(** Robots beyond those known that sense at least: of all open robots, or else of those inside. *)
Definition missing (c : case S) : Z * pred option_set :=
  let k := Z.sub (least c) (Z.of_nat (seen c)) in
  if Z.ltb Z0 k then (k, open)
  else (Z.sub (Z.sub (Z.of_nat (count_inside c)) (Z.of_nat (seen c))) (high c), open_inside).
Definition copies_worth (c : case S) : bool :=
  let m := missing c in
  let left := robots_that m.2 c in
  let r := Z.to_nat m.1 in
  [&& (0 < r)%N, (r <= size left)%N & average_worth (known c) left r].

(** Checks the case and adds what it lists to [found]. *)
Fixpoint check_cases (t : case_tree) (c : case S) (found : seq G) {struct t} : option (seq G) :=
  let both t1 c1 t2 c2 := if check_cases t1 c1 found is Some f then check_cases t2 c2 f else None in
  match t with
  | Sense i t1 t2 => if open (options_of c i) then both t1 (join c i) t2 (drop_sense c i) else None
  | Inside i t1 t2 =>
      let o := options_of c i in
      if may_out o && (may_sense o || may_blind o) then both t1 (bring c i) t2 (put c i only_out) else None
  | Sensing k t1 t2 =>
      if (k <= size (options c))%N then
        both t1 (with_sensing c (Z.max (least c) (Z.of_nat k)) (most c))
             t2 (with_sensing c (least c) (Z.min (most c) (Z.pred (Z.of_nat k))))
      else None
  | Blinding b t1 t2 =>
      if (b <= size (options c))%N then
        both t1 (with_blinded c (low c) (Z.min (high c) (Z.pred (Z.of_nat b))))
             t2 (with_blinded c (Z.max (low c) (Z.of_nat b)) (high c))
      else None
  | Limited k t1 => if narrow k c is Some c1 then check_cases t1 c1 found else None
  | IsWorth => if worth (known c) then Some found else None
  | CopiesWorth => if copies_worth c then Some found else None
  | NoBudget => if budget c then Some found else None
  | Dear k => if dear k c then Some found else None
  | IsListed =>
      match note c with
      | Some (Some g) => Some (g :: found)
      | Some None => Some found
      | None => None
      end
  end.

(** Robots of the group that are blinded at least. *)
Definition fewest_blinded (c : case S) : Z :=
  let more := Z.min (Z.sub (most c) (Z.of_nat (seen c))) (Z.of_nat (count open_inside (options c))) in
  Z.max (low c) (Z.sub (Z.of_nat (count_inside c)) (Z.add (Z.of_nat (seen c)) more)).
(** Fewer robots may sense than must. *)
Definition too_few (c : case S) : bool := Z.ltb (Z.of_nat (seen c + count open (options c))) (least c).
(** That; or more sense than may; or the same of blinded ones; or too few robots can be in the group. *)
Definition impossible (c : case S) : bool :=
  [|| too_few c, Z.ltb (most c) (Z.of_nat (seen c)), Z.ltb (most c) (least c),
      Z.ltb (high c) (fewest_blinded c)
    | Z.ltb (Z.of_nat (count (fun o => ~~ gone o) (options c))) (Z.add (least c) (low c))].
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
Definition blinded_size : nat := #|C :&: B|.
Definition may_be (o : option_set) (i : robot) : bool :=
  if i \in C then (if i \in B then may_blind o else may_sense o) else may_out o.

(** The group is one of the case. *)
Record stands (c : case S) : Prop := Stands {
  stands_known : exists T, [/\ known c = foldl add start T, uniq T, seen c = size T
    & forall i, (i \in T) = sure (options_of c i)];
  stands_size : size (options c) = robots w;
  stands_may : forall i : robot, may_be (options_of c i) i;
  stands_sensing : Z.le (least c) (Z.of_nat sensing_size) /\ Z.le (Z.of_nat sensing_size) (most c);
  stands_blinded : Z.le (low c) (Z.of_nat blinded_size) /\ Z.le (Z.of_nat blinded_size) (high c)
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

Lemma mem_robots_that (P : pred option_set) i : ~~ P nothing -> (i \in robots_that P c) = P (options_of c i).
Proof.
move=> np; rewrite mem_filter mem_iota add0n (stands_size st) leq0n /=; case e: (P _) => //=.
by apply: below_options => en; rewrite en (negbTE np) in e.
Qed.

Lemma robots_that_uniq (P : pred option_set) : uniq (robots_that P c).
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

Lemma may_cases (i : robot) : let o := options_of c i in let sees := i \in C :\: B in
  [/\ (sure o + (open o && sees) <= sees)%N, (sees <= sure o + (open o && sees))%N,
      (inside o <= (i \in C :&: B) + (sure o + (open_inside o && sees)))%N & (sees + (i \in C :&: B) <= ~~ gone o)%N].
Proof.
have := stands_may st i; rewrite /may_be /sure /open_inside /open /inside /gone !inE.
by case: (options_of c i) => [] [] [] [] //=; case: (_ \in C); case: (_ \in B).
Qed.

Definition sees_of (P : pred option_set) : nat := (\sum_(i : robot) (P (options_of c i) && (i \in C :\: B)))%N.

Lemma open_sensing : (seen c + sees_of open = sensing_size)%N.
Proof.
rewrite seenE /sees_of /sensing_size sum_mem -big_split /=; apply: eq_bigr => i _.
by have [h1 h2 _ _] := may_cases i; apply/eqP; rewrite eqn_leq h1 h2.
Qed.

Lemma inside_sensing : (count_inside c <= blinded_size + (seen c + sees_of open_inside))%N.
Proof.
rewrite seenE /count_inside count_options /blinded_size sum_mem -!big_split /=.
by apply: leq_sum => i _; have [] := may_cases i.
Qed.

Lemma not_gone_many : (sensing_size + blinded_size <= count (fun o => ~~ gone o) (options c))%N.
Proof.
rewrite (count_options (fun o => ~~ gone o)) /sensing_size /blinded_size !sum_mem -big_split /=.
by apply: leq_sum => i _; have [] := may_cases i.
Qed.

Lemma sees_of_le (P : pred option_set) : (sees_of P <= count P (options c))%N.
Proof. by rewrite count_options; apply: leq_sum => i _; case: (P _); case: (_ \in _). Qed.

Lemma inside_open_le : (sees_of open_inside <= sees_of open)%N.
Proof. by apply: leq_sum => i _; rewrite /open_inside; case: (open _); case: (inside _); case: (_ \in _). Qed.

(** What is known of the sensing robots with a property [R], about all. *)
Lemma count_robots (Q : pred nat) : count Q (iota 0 (robots w)) = (\sum_(i : robot) Q i)%N.
Proof.
have -> : iota 0 (robots w) = index_iota 0 (robots w) by rewrite /index_iota subn0.
by rewrite -sum1_count big_mkcond big_mkord; apply: eq_bigr => i _; case: (Q i).
Qed.

Lemma limited_sensing (R : pred nat) : (sensing_size <=
  #|[set i in C :\: B | R i]| + count (fun i => ~~ R i && may_sense (options_of c i)) (iota 0 (robots w)))%N.
Proof.
rewrite count_robots /sensing_size !sum_mem -big_split /=; apply: leq_sum => i _; have := stands_may st i.
by rewrite /may_be !inE; case: (options_of c i) => [] [] [] []; case: (i \in C); case: (i \in B); case: (R i).
Qed.

Lemma limited_blinded (R : pred nat) : (count (fun i => R i && inside (options_of c i)) (iota 0 (robots w)) <=
  #|[set i in C :\: B | R i]| + blinded_size)%N.
Proof.
rewrite count_robots /blinded_size !sum_mem -big_split /=; apply: leq_sum => i _; have := stands_may st i.
by rewrite /may_be /inside !inE; case: (options_of c i) => [] [] [] []; case: (i \in C); case: (i \in B); case: (R i).
Qed.

Lemma fewest_blindedP : Z.le (fewest_blinded c) (Z.of_nat blinded_size).
Proof.
have := inside_sensing; have := inside_open_le; have := open_sensing; have := sees_of_le open_inside.
have := stands_sensing st; have := stands_blinded st; rewrite /fewest_blinded; lia.
Qed.

Lemma not_impossible : ~~ impossible c.
Proof.
have := fewest_blindedP; have := open_sensing; have := sees_of_le open; have := not_gone_many.
have := stands_sensing st; have := stands_blinded st; rewrite /impossible /too_few; lia.
Qed.

Lemma not_too_few : ~~ too_few c.
Proof. by have := not_impossible; rewrite /impossible negb_or => /andP[]. Qed.
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

Hypotheses (worthP : worth_test start add phi p lower worth) (averageP : average_test start add phi p lower average_worth).

(** The robots of the group that are not blinded are in [V]. *)
Variables (C B V : {set robot}).
Hypothesis sensing : C :\: B \subset V.
Local Notation stands := (stands start add C B).
Local Notation sensing_size := (sensing_size C B).
Local Notation blinded_size := (blinded_size C B).

Section Values.
Variable c : case S.
Hypothesis st : stands c.

(** So many robots with some property that sense, beyond those known to. *)
Lemma missing_sensing (P : pred option_set) (T : seq nat) r : (forall o, P o -> open o) ->
  (forall i, (i \in T) = sure (options_of c i)) -> uniq T -> (r <= sees_of C B c P)%N ->
  exists T', [/\ uniq (T ++ T'), all below T', {subset T' <= robots_that P c}, size T' = r
    & forall i, i \in T ++ T' -> robot_of w i \in V].
Proof.
move=> Po TE uT le; pose rest := [seq i <- robots_that P c | robot_of w i \in C :\: B].
have np : ~~ P nothing by apply/negP => /Po.
have enough : (r <= size rest)%N.
  apply: leq_trans le _; rewrite /sees_of (eq_bigr (fun i : robot => if (i : nat) \in rest then 1 else 0)%N) => [|i _].
    rewrite -big_mkcond sum1_card cardE -(size_map (@nat_of_ord _)); apply: uniq_leq_size.
      by rewrite map_inj_uniq ?enum_uniq //; apply: val_inj.
    by move=> x /mapP[i]; rewrite mem_enum => iV ->.
  by rewrite mem_filter (mem_robots_that st) // robot_of_val andbC; case: (_ && _).
exists (take r rest); have sub x : x \in take r rest -> x \in rest by apply: mem_take.
have open_rest x : x \in take r rest -> open (options_of c x).
  by move/sub; rewrite mem_filter (mem_robots_that st) // => /andP[_ /Po].
have apart x : x \in take r rest -> x \notin T.
  by move/open_rest; rewrite TE /sure /open; case: (options_of c x) => [] [] [] [].
split.
- rewrite cat_uniq uT (take_uniq _ (filter_uniq _ (robots_that_uniq c P))) andbT /=.
  by apply/hasP => -[x /apart]; move/negbTE => /= ->.
- by apply/allP => x /open_rest; apply: (open_below st).
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

Lemma missingP : let m := missing c in (forall o, m.2 o -> open o) /\ Z.le m.1 (Z.of_nat (sees_of C B c m.2)).
Proof.
have := stands_sensing st; have := stands_blinded st; have := open_sensing st; have := inside_sensing st.
rewrite /missing; case: ifP => _ /=; split=> //; first by lia.
  by move=> o /andP[].
by lia.
Qed.

Lemma copies_worthP : copies_worth average_worth c -> lower <= phi (contributed p V).
Proof.
have [Po le] := missingP; rewrite /copies_worth; case: (missing c) Po le => k P /= Po le /and3P[r0 _ h].
have [T [kT uT _ TE]] := stands_known st; rewrite kT in h; have many : (Z.to_nat k <= sees_of C B c P)%N by lia.
have [T' [u b sub sz TV]] := missing_sensing Po TE uT many.
exact: averageP uT (all_below TE) r0 h _ _ u b sub sz TV.
Qed.
End Values.

(** ** The tree *)
Variables (G : eqType) (narrow : nat -> case S -> option (case S)).
Variables (budget : case S -> bool) (dear : nat -> case S -> bool) (note : case S -> option (option G)).
Variables (is_dear : Prop) (fits : G -> Prop).
Local Notation check := (check_cases add worth average_worth narrow budget dear note).
Hypotheses (narrowP : forall k c c', stands c -> narrow k c = Some c' -> stands c')
  (budgetP : forall c, stands c -> ~~ budget c)
  (dearP : forall k c, stands c -> dear k c -> is_dear)
  (noteP : forall c g, stands c -> note c = Some g -> is_dear \/ exists2 h, g = Some h & fits h).

Lemma check_keeps t c found f : check t c found = Some f -> {subset found <= f}.
Proof.
elim: t c found f => [i t1 IH1 t2 IH2|i t1 IH1 t2 IH2|k t1 IH1 t2 IH2|b t1 IH1 t2 IH2|k t1 IH||||k|] c found f /=.
1-4: by case: ifP => // _; case e: (check t1 _ _) => [f1|//] h x /(IH1 _ _ _ e); exact: IH2 h x.
1: by case: (narrow k c) => [c1|//]; exact: IH.
1-4: by case: ifP => // _ [->].
by case: (note c) => [[g|]|] // [<-] // x xf; rewrite in_cons xf orbT.
Qed.

Theorem check_casesP t c found f : check t c found = Some f -> stands c ->
  lower <= phi (contributed p V) \/ is_dear \/ (exists2 g, g \in f & fits g).
Proof.
have later t' c' f1 f2 : check t' c' f1 = Some f2 ->
    lower <= phi (contributed p V) \/ is_dear \/ (exists2 g, g \in f1 & fits g) ->
    lower <= phi (contributed p V) \/ is_dear \/ (exists2 g, g \in f2 & fits g).
  move=> /check_keeps sub [h|[h|[g gf h]]]; [by left|by right; left|right; right; exists g => //; exact: sub].
elim: t c found f => [i t1 IH1 t2 IH2|i t1 IH1 t2 IH2|k t1 IH1 t2 IH2|b t1 IH1 t2 IH2|k t1 IH||||k|] c found f /=.
- case: ifP => // oi; case e: (check t1 _ _) => [f1|//] h st.
  have [iV|iV] := boolP (robot_of w i \in C :\: B); last by apply: IH2 h _; apply: (stands_drop st).
  apply: later h _; apply: IH1 e _; exact: (stands_join st (open_below st oi) (open_not_sure oi) iV).
- case: ifP => // /andP[oo os]; case e: (check t1 _ _) => [f1|//] h st.
  have il : (i < robots w)%N by apply: (below_options st) => e'; rewrite e' in oo.
  have ns : ~~ sure (options_of c i) by rewrite /sure oo orbT andbF.
  have mi := may_at st il.
  have [iC|iC] := boolP (robot_of w i \in C); last first.
    by apply: IH2 h _; apply: (stands_put st) => //; rewrite /may_be (negbTE iC).
  apply: later h _; apply: IH1 e _; rewrite /bring; case: ifP => mb; last first.
    by apply: (stands_join st) => //; move: mi; rewrite /may_be iC !inE iC mb; case: (_ \in B).
  apply: (stands_put st) => //; first by rewrite /sure /= mb andbF.
  by move: mi; rewrite /may_be iC.
- case: ifP => // _; case e: (check t1 _ _) => [f1|//] h st; have [few|many] := ltnP sensing_size k.
    apply: IH2 h _; case: (st) => ? ? ? [s1 s2] ?; split=> //=; split; lia.
  apply: later h _; apply: IH1 e _; case: (st) => ? ? ? [s1 s2] ?; split=> //=; split; lia.
- case: ifP => // _; case e: (check t1 _ _) => [f1|//] h st; have [few|many] := ltnP blinded_size b.
    apply: later h _; apply: IH1 e _; case: (st) => ? ? ? ? [s1 s2]; split=> //=; split; lia.
  apply: IH2 h _; case: (st) => ? ? ? ? [s1 s2]; split=> //=; split; lia.
- by case ek: (narrow k c) => [c1|//] h st; apply: IH h (narrowP st ek).
- by case: ifP => // h _ st; left; apply: (known_worth st h).
- by case: ifP => // h _ st; left; apply: (copies_worthP st h).
- by case: ifP => // h _ st; have := budgetP st; rewrite h.
- by case: ifP => // h _ st; right; left; apply: dearP st h.
case e: (note c) => [[g|]|] // [<-] st; right; have [d|[h]] := noteP st e; [by left| |by left|by []].
by case=> <- fh; right; exists g; rewrite ?mem_head.
Qed.
End Soundness.
