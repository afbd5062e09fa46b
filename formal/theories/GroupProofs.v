(** Lower proofs by groups: any so many robots are worth the claim, or any of some robots; dual prices show that the groups of an attack that
    are not cost too much together, or that those which do not cannot cover the team. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify ssrZ.
From Ratt Require Import Extrema Teams Graph Worth CaseTree Costs AttackGroups.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** Any [set_size] robots that sense in one group are worth the claim. *)
Record sets_lemma := Sets { set_size : nat; set_tree : case_tree }.
(** A limit: the same of those robots that are [limited]. Limits may name those before them. *)
Record limit := Limit { limited : seq bool; limit_lemma : sets_lemma }.
Record group_tree := GroupTree { dual : prices; bounds : seq flow_bound; limits : seq limit; groups : case_tree }.

(** A listed group: who is in it; what it costs at least, its robots that are blinded at least, its links to others. *)
Definition listed_group := (seq bool * (Z * Z * Z))%type.
Definition who (g : listed_group) : seq bool := g.1.
Definition costs (g : listed_group) : Z := g.2.1.1.
Definition needs (g : listed_group) : Z := g.2.1.2.
Definition loses (g : listed_group) : Z := g.2.2.

Section Checker.
Variables (w : network) (S : Type) (start : S) (add : S -> nat -> S) (worth : S -> bool).
Variable (average_worth : S -> seq nat -> nat -> bool).
Local Notation n := (robots w).

Definition set_case (among : seq bool) (size : nat) : case S :=
  let k := Z.of_nat size in
  Case start 0 k k Z0 Z0 [seq if nth false among i then Options true false true else only_out | i <- iota 0 n].
(** Fewer may sense than must, or more must than may. *)
Definition no_set (c : case S) : bool := too_few c || Z.ltb (most c) (least c).

(** What a limit says of a case: so many robots sense at most, and so many are blinded at least. *)
Definition limit_most (l : limit) : Z := Z.pred (Z.of_nat (set_size (limit_lemma l))).
Definition count_robots (P : nat -> option_set -> bool) (c : case S) : Z :=
  Z.of_nat (count (fun i => P i (options_of c i)) (iota 0 n)).
Definition apply_limit (l : limit) (c : case S) : case S :=
  let others := count_robots (fun i o => ~~ nth false (limited l) i && may_sense o) c in
  let within := count_robots (fun i o => nth false (limited l) i && inside o) c in
  Case (known c) (seen c) (least c) (Z.min (most c) (Z.add (limit_most l) others))
    (Z.max (low c) (Z.sub within (limit_most l))) (high c) (options c).
Definition narrow (ls : seq limit) (k : nat) (c : case S) : option (case S) :=
  if drop k ls is l :: _ then Some (apply_limit l c) else None.

Definition check_sets_among (ls : seq limit) (among : seq bool) (l : sets_lemma) : bool :=
  (set_size l <= n.+1)%N &&
  if check_cases add worth average_worth (narrow ls) no_set (fun _ _ => false)
       (fun _ => None : option (option unit)) (set_tree l) (set_case among (set_size l)) [::] is Some _ then true else false.
Definition check_sets : sets_lemma -> bool := check_sets_among [::] (nseq n true).
Fixpoint check_limits (known ls : seq limit) : bool :=
  if ls is l :: ls' then check_sets_among known (limited l) (limit_lemma l) && check_limits (rcons known l) ls' else true.

Variables (size_k : nat) (near tied : seq (seq bool)).
Definition start_case : case S :=
  Case start 0 Z0 (Z.pred (Z.of_nat size_k)) Z0 (Z.of_nat (spare w)) [seq Options true (i \notin kept_robots w) true | i <- iota 0 n].

Variables (t : group_tree).
Definition tree_ok : bool :=
  [&& prices_ok w (dual t), all (bound_ok w (dual t) near tied) (bounds t)
    & check_limits [::] (limits t)].
Definition is_dear (limit : Z) (k : nat) (c : case S) : bool :=
  if drop k (bounds t) is b :: _ then Z.ltb limit (flow_value w (dual t) near b c) else false.

Definition cost_of_members (os : seq option_set) (links need : Z) : Z :=
  Z.sub (Z.add (Z.mul (link_price (dual t)) links) (Z.mul (blind_price (dual t)) need))
    (zsum [seq if inside x.1 then x.2 else Z0 | x <- zip os (robot_prices (dual t))]).
Definition list_group (c : case S) : option (option listed_group) :=
  let os := options c in
  if all (fun o => inside o || gone o) os then
    let links := leaving os near in
    let need := Z.max Z0 (fewest_blinded c) in
    if [|| ~~ has inside os, Z.ltb (Z.of_nat (cut_budget w)) links, Z.ltb Z0 (leaving os tied)
         | Z.ltb (Z.of_nat (spare w)) need] then Some None
    else
      let cost := cost_of_members os links need in
      if Z.ltb cost Z0 then None
      else if Z.ltb (slack w (dual t)) cost then Some None
      else Some (Some ([seq inside o | o <- os], (cost, need, links)))
  else None.

(** *** Groups listed twice count once *)
Definition key (g : listed_group) : Z := foldl (fun k (b : bool) => Z.add (Z.add k k) (if b then Zpos xH else Z0)) Z0 (who g).
Definition cheaper (g h : listed_group) : listed_group :=
  (who g, (Z.min (costs g) (costs h), Z.min (needs g) (needs h), Z.min (loses g) (loses h))).
Fixpoint squash (s : seq (Z * Z * listed_group)) : seq (Z * Z * listed_group) :=
  match s with
  | x :: s' =>
      match squash s' with
      | y :: r =>
          if Z.eqb x.1.1 y.1.1 && (who x.2 == who y.2) then (x.1, cheaper x.2 y.2) :: r
          else x :: y :: r
      | [::] => [:: x]
      end
  | [::] => [::]
  end.
Fixpoint number (k : Z) (s : seq listed_group) : seq (Z * Z * listed_group) :=
  if s is g :: s' then (key g, k, g) :: number (Z.succ k) s' else [::].
Definition distinct (s : seq listed_group) : seq listed_group :=
  let once := squash (sort (fun x y => Z.leb x.1.1 y.1.1) (number Z0 s)) in
  [seq x.2 | x <- sort (fun x y => Z.leb x.1.2 y.1.2) once].

(** *** No listed groups are the groups of an attack *)
Definition chosen_groups := (seq bool * (Z * Z * Z))%type.
Definition together (c : chosen_groups) (g : listed_group) : Z * Z * Z :=
  (Z.add c.2.1.1 (costs g), Z.add c.2.1.2 (needs g), Z.add c.2.2 (loses g)).
Definition fitting (c : chosen_groups) (g : listed_group) : bool :=
  let x := together c g in
  [&& Z.leb x.1.1 (slack w (dual t)), Z.leb x.1.2 (Z.of_nat (spare w)), Z.leb x.2 (Z.of_nat (cut_budget w + cut_budget w))
    & all (fun y => ~~ (y.1 && y.2)) (zip c.1 (who g))].
Definition choose (c : chosen_groups) (g : listed_group) : chosen_groups :=
  ([seq x.1 || x.2 | x <- zip c.1 (who g)], together c g).
Fixpoint no_partition (holds : seq (seq listed_group)) (nodes : seq nat) (stack : seq chosen_groups) : bool :=
  match nodes, stack with
  | i :: nodes', c :: stack' =>
      ~~ nth true c.1 i &&
      no_partition holds nodes' ([seq choose c g | g <- nth [::] holds i & fitting c g] ++ stack')
  | [::], [::] => true
  | _, _ => false
  end.

Definition check_duals : bool :=
  [&& tree_ok, Z.ltb (slack w (dual t)) Z0
    & if check_cases add worth average_worth (narrow (limits t)) (@beyond_budgets w near tied S) (is_dear (Zneg xH)) (fun _ => None : option (option listed_group))
           (groups t) start_case [::] is Some _ then true else false].
Definition check_cover (nodes : seq nat) : bool :=
  [&& tree_ok, Z.leb Z0 (slack w (dual t))
    & if check_cases add worth average_worth (narrow (limits t)) (@beyond_budgets w near tied S) (is_dear (slack w (dual t)))
           list_group (groups t) start_case [::] is Some found then
        let gs := distinct (rev found) in
        all (fun g => [&& Z.leb Z0 (costs g), Z.leb Z0 (needs g) & Z.leb Z0 (loses g)]) gs &&
        no_partition [seq [seq g <- gs | nth false (who g) i] | i <- iota 0 n] nodes [:: (nseq n false, (Z0, Z0, Z0))]
      else false].
End Checker.

(** ** Listed groups *)
Lemma squashP s x : x \in s -> exists2 y, y \in squash s &
  [/\ who y.2 = who x.2, Z.le (costs y.2) (costs x.2), Z.le (needs y.2) (needs x.2) & Z.le (loses y.2) (loses x.2)].
Proof.
elim: s x => [//|z s IH] x; rewrite in_cons => /orP[/eqP->|xs].
  rewrite /=; case: (squash s) => [|y r]; first by exists z; rewrite ?mem_head //; split=> //; lia.
  case: ifP => [/andP[_ /eqP e]|_]; last by exists z; rewrite ?mem_head //; split=> //; lia.
  by exists (z.1, cheaper z.2 y.2); rewrite ?mem_head //; rewrite /cheaper /costs /needs /loses /=; split=> //; lia.
have [y ys [e1 e2 e3 e4]] := IH x xs; rewrite /=; move: ys; case: (squash s) => [//|y' r] ys.
case: ifP => [/andP[_ /eqP e]|_]; last by exists y => //; rewrite in_cons ys orbT.
move: ys; rewrite in_cons => /orP[/eqP ey|yr]; last by exists y => //; rewrite in_cons yr orbT.
subst y; exists (z.1, cheaper z.2 y'.2); rewrite ?mem_head //.
split; [exact: etrans e e1| | |]; apply: Z.le_trans (Z.le_min_r _ _) _; by [].
Qed.

Lemma distinctP s g : g \in s -> exists2 h, h \in distinct s &
  [/\ who h = who g, Z.le (costs h) (costs g), Z.le (needs h) (needs g) & Z.le (loses h) (loses g)].
Proof.
move=> gs; have [k kg] : exists k, (key g, k, g) \in number Z0 s.
  elim: s Z0 gs => [//|x s IH] k; rewrite in_cons => /orP[/eqP->|/IH h]; first by exists k; rewrite mem_head.
  by have [l kl] := h (Z.succ k); exists l; rewrite in_cons kl orbT.
have xs : (key g, k, g) \in sort (fun x y => Z.leb x.1.1 y.1.1) (number Z0 s) by rewrite mem_sort.
have [y ys h] := squashP xs; exists y.2 => //; apply: map_f; by rewrite mem_sort.
Qed.

(** ** Soundness *)
Section Soundness.
Local Open Scope ring_scope.
Variables (w : network) (S : Type) (start : S) (add : S -> nat -> S) (worth : S -> bool).
Variable (average_worth : S -> seq nat -> nat -> bool).
Hypothesis ok : network_ok w.
Local Notation robot := 'I_(top_robot w).+1.
Local Notation element := 'I_(top_element w).+1.
Variables (F : realFieldType) (phi : {set element} -> F) (p : {ffun robot -> element}) (lower : F).
Local Notation below := (fun i => (i < robots w)%N).
Hypotheses (worthP : worth_test start add phi p lower worth) (averageP : average_test start add phi p lower average_worth).
Local Notation check_sets_among := (check_sets_among w start add worth average_worth).
Local Notation check_sets := (check_sets w start add worth average_worth).
Local Notation check_limits := (check_limits w start add worth average_worth).

(** Any so many of the robots are worth the claim; and this of all limits of a list. *)
Definition holds_of (among : seq bool) (size : nat) : Prop := forall V : {set robot},
  (size <= #|[set i in V | nth false among i]|)%N -> lower <= phi (contributed p V).
Definition all_hold (ls : seq limit) : Prop := forall k l ls', drop k ls = l :: ls' -> holds_of (limited l) (set_size (limit_lemma l)).

Lemma apply_limitP (C B : {set robot}) l c : (#|[set i in C :\: B | nth false (limited l) i]| < set_size (limit_lemma l))%N ->
  stands start add C B c -> stands start add C B (apply_limit w l c).
Proof.
set R := nth false (limited l) => few st; have := limited_sensing st R; have := limited_blinded st R.
case: (st) => ? ? ? [s1 s2] [b1 b2] le1 le2; split=> //=; rewrite /limit_most /count_robots -/R.
all: move: few le1 le2 s1 s2 b1 b2; clear.
all: by move: #|_| (count _ _) (count _ _) (sensing_size _ _) (blinded_size _ _) => few others within s b; split; lia.
Qed.

Lemma narrow_stands (C B V : {set robot}) ls k c c' : C :\: B \subset V -> all_hold ls -> ~~ (lower <= phi (contributed p V)) ->
  stands start add C B c -> narrow w ls k c = Some c' -> stands start add C B c'.
Proof.
move=> sub hold low st; rewrite /narrow; case el: (drop k ls) => [//|l ls'] [<-]; apply: apply_limitP => //.
rewrite ltnNge; apply: contra low => many; apply: (hold _ _ _ el); apply: leq_trans many _.
by apply: subset_leq_card; apply/subsetP => i; rewrite !inE => /andP[h ->]; rewrite andbT; apply: (subsetP sub); rewrite !inE.
Qed.

Theorem check_sets_amongP ls among l : all_hold ls -> check_sets_among ls among l -> holds_of among (set_size l).
Proof.
move=> hold h V; move: h; have [//|low] := boolP (lower <= phi (contributed p V)).
rewrite /GroupProofs.check_sets_among; set k := set_size l => /andP[_]; case e: (check_cases _ _ _ _ _ _ _ _ _ _) => [f|//] _ le.
have [C CV cC] := part_of_size le.
have inC (i : robot) : i \in C -> (i \in V) && nth false among i by move/(subsetP CV); rewrite inE.
have sC : sensing_size C set0 = k by rewrite /sensing_size setD0.
have bC : blinded_size C set0 = 0%N by rewrite /blinded_size setI0 cards0.
have sub : C :\: set0 \subset V by rewrite setD0; apply/subsetP => i /inC /andP[].
have first_options i : options_of (set_case w start among k) i =
    if (i < robots w)%N then (if nth false among i then Options true false true else only_out) else nothing.
  rewrite /options_of -[options _]/(map _ (iota 0 (robots w))).
  case: ltnP => il; first by rewrite (nth_map 0%N) ?size_iota // nth_iota.
  by rewrite nth_default // size_map size_iota.
have st : stands start add C set0 (set_case w start among k).
  split; rewrite ?size_map ?size_iota ?sC ?bC //; last by split; apply: Z.le_refl.
  - by exists [::]; split=> // i; rewrite first_options; case: ifP => //; case: ifP.
  move=> i; rewrite /may_be first_options ltn_ord !inE; case: ifP => [/inC /andP[_ ->] //|_].
  by case: ifP.
have budget (c : case S) : stands start add C set0 c -> ~~ no_set c.
  by move=> stc; rewrite /no_set negb_or (not_too_few stc); have := not_impossible stc; rewrite /impossible !negb_or => /and5P[].
have limit_ok (i : nat) (c c' : case S) : stands start add C set0 c -> narrow w ls i c = Some c' -> stands start add C set0 c'.
  exact: (narrow_stands sub hold low).
have no_dear (i : nat) (c : case S) : stands start add C set0 c -> false -> False by [].
have no_list (c : case S) (g : option unit) : stands start add C set0 c -> None = Some g ->
  False \/ exists2 h, g = Some h & False by [].
by have [le'|[//|[g _ []]]] := check_casesP (G := unit_eqType) (fits := fun _ => False) worthP averageP sub limit_ok budget
  no_dear no_list e st; rewrite le' in low.
Qed.

Lemma check_limitsP known ls : all_hold known -> check_limits known ls -> all_hold (known ++ ls).
Proof.
elim: ls known => [|l ls IH] known hold; first by rewrite cats0.
move=> /= /andP[h rest]; rewrite -cat_rcons; apply: IH rest => k l' ls'.
have new := check_sets_amongP hold h; rewrite -cats1 drop_cat; case: ltnP => _; last first.
  by case: (k - size known)%N => [|j] //= [<- _].
by case ek: (drop k known) => [|x xs] /= [<- _] //; exact: (hold _ _ _ ek).
Qed.

Theorem check_setsP l (V : {set robot}) : check_sets l -> (set_size l <= #|V|)%N -> lower <= phi (contributed p V).
Proof.
move=> h le; have none : all_hold [::] by [].
apply: (check_sets_amongP none h); apply: leq_trans le _; apply: subset_leq_card; apply/subsetP => i iV.
by rewrite inE iV nth_nseq ltn_ord.
Qed.

(** ** The groups of one attack that leaves none worth the claim *)
Variables (size_k : nat) (t : group_tree) (a : attack [finType of robot]).
Hypotheses (set_worth : forall V : {set robot}, (size_k <= #|V|)%N -> lower <= phi (contributed p V))
  (oka : allowed (team_of w) a) (poor : forall i, ~~ (lower <= phi (contributed p (sees (team_of w) a i)))).
Local Notation e := (linked (team_of w) a).
Local Notation B := (blinded a).
Local Notation near := (rows_of w (link_list w)).
Local Notation tied := (rows_of w (kept_links w)).
Local Notation d := (dual t).
Local Notation root_case := (start_case w start size_k).
Hypothesis tree_good : tree_ok w start add worth average_worth near tied t.

Lemma prices_good : prices_ok w d.
Proof. by case/and3P: tree_good. Qed.

Section OneGroup.
Variable r : robot.
Hypothesis is_root : roots e r.
Local Notation C := (part a r).
Local Notation real_cost := (cost d C B).

Lemma sees_part : sees (team_of w) a r = C :\: B.
Proof. by rewrite /sees -part_group (eqP is_root). Qed.

Lemma root_in : r \in C.
Proof. by rewrite inE; apply: is_root. Qed.

Lemma root_stands : stands start add C B root_case.
Proof.
have root_options i : options_of root_case i = if (i < robots w)%N then Options true (i \notin kept_robots w) true else nothing.
  rewrite /options_of -[options _]/(map _ (iota 0 (robots w))).
  case: ltnP => il; first by rewrite (nth_map 0%N) ?size_iota // nth_iota.
  by rewrite nth_default // size_map size_iota.
split.
- by exists [::]; split=> // i; rewrite root_options; case: ifP => //; case: (_ \notin _).
- by rewrite size_map size_iota.
- move=> i; rewrite /may_be root_options ltn_ord; case: ifP => // _; case: ifP => //= iB.
  by case/and5P: oka => _ _ _ dis _; have := disjointFr dis iB; rewrite inE => ->.
- have : ~~ (size_k <= sensing_size C B)%N by apply: contra (poor r); rewrite sees_part; apply: set_worth.
  by rewrite -ltnNge /=; lia.
by have := part_blinded oka r; rewrite /=; lia.
Qed.

Definition fits (g : listed_group) : Prop := [/\ size (who g) = robots w, forall i : robot, nth false (who g) i = (i \in C),
  Z.le (costs g) real_cost, Z.le (needs g) (Z.of_nat (blinded_size C B)) & Z.le (loses g) (Z.of_nat (links_left C))].

Lemma is_dearP limit k c : stands start add C B c -> is_dear w near t limit k c -> Z.lt limit real_cost.
Proof.
move=> st; rewrite /is_dear; case ed: (drop k (bounds t)) => [//|b bs] /Z.ltb_lt lt.
have good : bound_ok w d near tied b.
  by case/and3P: tree_good => _ + _; rewrite -(cat_take_drop k (bounds t)) all_cat ed => /and3P[].
apply: Z.lt_le_trans lt _.
exact: (flow_valueP (part_links ok oka r) (@untied_part _ _ ok oka r) st prices_good good).
Qed.

Lemma narrowP k c c' : stands start add C B c -> narrow w (limits t) k c = Some c' -> stands start add C B c'.
Proof.
have none : all_hold [::] by [].
apply: (narrow_stands (V := C :\: B)) => //; first by case/and3P: tree_good => _ _ /(check_limitsP none).
by rewrite -sees_part; apply: poor.
Qed.

Lemma no_budgetP c : stands start add C B c -> ~~ beyond_budgets w near tied c.
Proof.
move=> st; exact: (not_beyond_budgets (part_links ok oka r) (@untied_part _ _ ok oka r) st (@whole_part _ _ ok r)).
Qed.

Lemma list_groupP c o : stands start add C B c -> list_group w near tied t c = Some o ->
  Z.lt (slack w d) real_cost \/ exists2 g, o = Some g & fits g.
Proof.
move=> st; rewrite /list_group; case: ifP => // decided; have so := stands_size st.
have each (i : robot) : inside (options_of c i) || gone (options_of c i).
  by have /(all_nthP nothing)/(_ (i : nat)) := decided; rewrite so ltn_ord => /(_ isT).
have mem (i : robot) : inside (options_of c i) = (i \in C).
  apply/idP/idP => [h|h]; first by apply: contraTT h => iC; apply: (not_inside st iC).
  by have := each i; rewrite (negbTE (not_gone st h)) orbF.
have few := fewest_blindedP st; rewrite -/(blinded_size C B) in few.
have bl := part_blinded oka r.
rewrite (leaving_all st each) (leaving_tied (@untied_part _ _ ok oka r) st).
have links := part_links ok oka r.
have -> : has inside (options c) by apply/(has_nthP nothing); exists (r : nat); rewrite ?so ?ltn_ord // -/(options_of c r) mem root_in.
case: ifP => [|_]; first by rewrite /=; lia.
set need := Z.max _ _; set x := cost_of_members _ _ _ _.
have need_le : Z.le need (Z.of_nat (blinded_size C B)) by rewrite /need; lia.
have x_le : Z.le x real_cost.
  have -> : x = Z.sub (Z.add (Z.mul (link_price d) (Z.of_nat (links_left C))) (Z.mul (blind_price d) need)) (\sum_(i in C) price_of d i).
    rewrite /x /cost_of_members; congr (Z.sub _ _).
    rewrite (zsum_nth (nothing, Z0) (n := robots w)); last by rewrite size_zip so (prices_size prices_good) minnn.
    rewrite [RHS]big_mkcond; apply: eq_bigr => i _; rewrite nth_zip ?so ?(prices_size prices_good) //=.
    by rewrite -/(options_of c i) mem.
  have m0 : Z.le 0 (blind_price d) by case/and3P: prices_good => _ /Z.leb_le.
  by have := Z.mul_le_mono_nonneg_l _ _ _ m0 need_le; rewrite /cost; lia.
case: ifP => // _; case: ifP => [lt|_] [<-]; first by left; lia.
right; eexists; first by []; split; [by rewrite size_map | | exact: x_le | exact: need_le | exact: Z.le_refl].
by move=> i; rewrite (nth_map nothing) ?so ?ltn_ord // -/(options_of c i) mem.
Qed.

(** The group costs more than the limit, or is listed. *)
Lemma group_found limit note found (P : listed_group -> Prop) : (forall c o, stands start add C B c -> note c = Some o ->
    Z.lt limit real_cost \/ exists2 g, o = Some g & P g) ->
  check_cases add worth average_worth (narrow w (limits t)) (@beyond_budgets w near tied S) (is_dear w near t limit) note
    (groups t) root_case [::] = Some found ->
  Z.lt limit real_cost \/ exists2 g, g \in found & P g.
Proof.
move=> noteP h.
have [le|//] := check_casesP worthP averageP (fintype.subxx _) narrowP no_budgetP (fun k c st => @is_dearP limit k c st) noteP h root_stands.
by have := poor r; rewrite sees_part le.
Qed.
End OneGroup.

Lemma sum_roots_le (A : pred robot) (f g : robot -> Z) : (forall r, A r -> roots e r /\ Z.le (f r) (g r)) ->
  (forall r, roots e r -> Z.le 0 (g r)) -> Z.le (\sum_(r | A r) f r) (\sum_(r | roots e r) g r).
Proof.
move=> h h0; rewrite big_mkcond [X in Z.le _ X]big_mkcond; apply: sum_le => r.
case: ifP => [/h[-> //]|_]; by case: ifP => [/h0 //|_]; lia.
Qed.

Theorem no_duals : ~~ check_duals w start add worth average_worth size_k near tied t.
Proof.
apply/negP => /and3P[_ /Z.ltb_lt neg]; case h: (check_cases _ _ _ _ _ _ _ _ _ _) => [found|//] _.
have each r : roots e r -> Z.le 0 (cost d (part a r) B).
  move=> rr; have nothing_listed c (o : option listed_group) : stands start add (part a r) B c -> None = Some o ->
    Z.lt (Zneg xH) (cost d (part a r) B) \/ exists2 g, o = Some g & False by [].
  have [|[g _ []]] := group_found rr nothing_listed h; lia.
have := all_costs ok oka prices_good.
have := @sum_roots_le (fun _ => false) (fun _ => Z0) (fun r => cost d (part a r) B) _ each.
rewrite big_pred0 // => /(_ (fun r h => ltac:(discriminate h))); lia.
Qed.

(** ** Covers *)
Section Cover.
Variables (gs : seq listed_group) (chosen : robot -> listed_group).
Hypothesis valid : all (fun g => [&& Z.leb Z0 (costs g), Z.leb Z0 (needs g) & Z.leb Z0 (loses g)]) gs.
Hypothesis chosenP : forall r, roots e r -> chosen r \in gs /\ fits r (chosen r).
Local Notation holds := [seq [seq g <- gs | nth false (who g) i] | i <- iota 0 (robots w)].

(** Groups of the attack, by their roots, are what a case has chosen. *)
Definition really (c : chosen_groups) : Prop := exists R : {set robot},
  [/\ forall r, r \in R -> roots e r, size c.1 = robots w, forall i : robot, nth true c.1 i = (fingraph.root e i \in R)
    & c.2 = (\sum_(r in R) costs (chosen r), \sum_(r in R) needs (chosen r), \sum_(r in R) loses (chosen r))].

Lemma chosen_valid r : roots e r -> [/\ Z.le 0 (costs (chosen r)), Z.le 0 (needs (chosen r)) & Z.le 0 (loses (chosen r))].
Proof.
by case/chosenP => inr _; have /and3P[/Z.leb_le ? /Z.leb_le ? /Z.leb_le ?] := allP valid _ inr.
Qed.

Lemma within_limits (R : {set robot}) : (forall r, r \in R -> roots e r) ->
  [/\ Z.le (\sum_(r in R) costs (chosen r)) (slack w d), Z.le (\sum_(r in R) needs (chosen r)) (Z.of_nat (spare w))
    & Z.le (\sum_(r in R) loses (chosen r)) (Z.of_nat (cut_budget w + cut_budget w))].
Proof.
move=> Rr; have le_all (f g : robot -> Z) : (forall r, roots e r -> Z.le 0 (f r) /\ Z.le (f r) (g r)) ->
    Z.le (\sum_(r in R) f r) (\sum_(r | roots e r) g r).
  move=> h; apply: sum_roots_le => r; first by move=> /Rr rr; have [] := h r rr.
  by move=> /h[]; lia.
have nat_sum (f : robot -> nat) : \sum_(r | roots e r) Z.of_nat (f r) = Z.of_nat (\sum_(r | roots e r) f r)%N.
  by rewrite [in RHS]big_mkcond sum_nat big_mkcond; apply: eq_bigr => r _; case: ifP.
split.
- apply: Z.le_trans (all_costs ok oka prices_good); apply: le_all => r rr.
  by have [h _ _] := chosen_valid rr; have [_ []] := chosenP rr.
- apply: Z.le_trans (_ : Z.le (\sum_(r | roots e r) Z.of_nat (blinded_size (part a r) B)) _).
    by apply: le_all => r rr; have [_ h _] := chosen_valid rr; have [_ []] := chosenP rr.
  by rewrite nat_sum; have := all_blinded oka; lia.
apply: Z.le_trans (_ : Z.le (\sum_(r | roots e r) Z.of_nat (links_left (part a r))) _).
  by apply: le_all => r rr; have [_ _ h] := chosen_valid rr; have [_ []] := chosenP rr.
by rewrite nat_sum; have := all_links ok oka; lia.
Qed.

Lemma no_partitionP nodes stack : no_partition w t holds nodes stack -> forall c, c \in stack -> really c -> False.
Proof.
elim: nodes stack => [|i nodes IH] [|c0 stack] //= /andP[out h] c; rewrite in_cons => /orP[/eqP->|cs]; last first.
  by apply: (IH _ h c); rewrite mem_cat cs orbT.
case=> R [Rr sz cov sums].
have il : (i < robots w)%N by rewrite ltnNge -sz; apply: contra out => /(nth_default true) ->.
pose k := robot_of w i; pose r := fingraph.root e k; pose g := chosen r.
have ki : (k : nat) = i by rewrite /k robot_ofK.
have rR : r \notin R by rewrite -cov ki.
have rr : roots e r := roots_root a k; have [gin [sg mg _ _ _]] := chosenP rr.
have R'r q : q \in r |: R -> roots e q by case/setU1P => [->|/Rr].
have add_one (f : robot -> Z) : Z.add (\sum_(q in R) f q) (f r) = \sum_(q in r |: R) f q.
  by rewrite big_setU1 //= Z.add_comm.
have sums' : together c0 g = (\sum_(q in r |: R) costs (chosen q), \sum_(q in r |: R) needs (chosen q),
    \sum_(q in r |: R) loses (chosen q)).
  by rewrite /together sums /= !add_one.
have held : g \in nth [::] holds i.
  by rewrite (nth_map 0%N) ?size_iota // nth_iota // add0n mem_filter gin andbT -ki mg mem_part.
have memg (j : robot) : nth false (who g) j = (fingraph.root e j == r) by rewrite mg inE.
have szip : size (zip c0.1 (who g)) = robots w by rewrite size_zip sz sg minnn.
apply: (IH _ h (choose c0 g)); first (rewrite mem_cat; apply/orP; left).
  apply/mapP; exists g => //; rewrite mem_filter held andbT /fitting sums' /=.
  have [/Z.leb_le-> /Z.leb_le-> /Z.leb_le->] := within_limits R'r; apply/(all_nthP (true, false)) => j.
  rewrite szip => jl; rewrite nth_zip ?sz ?sg //= -[j]/(nat_of_ord (Ordinal jl)) cov memg.
  by case: eqP => [->|_]; rewrite ?andbF // andbT.
exists (r |: R); split=> //; first by rewrite size_map.
move=> j; rewrite (nth_map (true, false)) ?szip ?ltn_ord // nth_zip ?sz ?sg //= cov memg in_setU1.
by rewrite orbC.
Qed.
End Cover.

Theorem no_cover nodes : ~~ check_cover w start add worth average_worth size_k near tied t nodes.
Proof.
apply/negP => /and3P[_ /Z.leb_le pos]; case h: (check_cases _ _ _ _ _ _ _ _ _ _) => [found|//] /andP[valid none].
set gs := distinct (rev found) in valid none.
have each r : roots e r -> Z.lt (slack w d) (cost d (part a r) B) \/ exists2 g, g \in gs & fits r g.
  move=> rr; have [lt|[g gf [sg mg cg ng lg]]] := group_found rr (list_groupP rr) h; first by left.
  right; have gr : g \in rev found by rewrite mem_rev.
  have [x xg [e1 e2 e3 e4]] := distinctP gr; exists x => //; split; rewrite ?e1 //.
  - exact: Z.le_trans e2 cg.
  - exact: Z.le_trans e3 ng.
  exact: Z.le_trans e4 lg.
have all_valid g : g \in gs -> Z.le 0 (costs g) by move/(allP valid) => /and3P[/Z.leb_le].
have pos_cost r : roots e r -> Z.le 0 (cost d (part a r) B).
  by move=> rr; have [|[g /all_valid ? [_ _ ? _ _]]] := each r rr; lia.
have fit r : roots e r -> exists2 g, g \in gs & fits r g.
  move=> rr; have [lt|//] := each r rr; have := all_costs ok oka prices_good.
  have := @sum_roots_le (pred1 r) (fun r => cost d (part a r) B) (fun r => cost d (part a r) B) _ pos_cost.
  by rewrite big_pred1_eq => le; have := le (fun q => ltac:(by move=> /eqP->; split=> //; apply: Z.le_refl)); lia.
have [chosen chosenP] : exists chosen : robot -> listed_group, forall r, roots e r -> chosen r \in gs /\ fits r (chosen r).
  apply: (@fin_all_exists _ (fun _ => listed_group) (fun r g => roots e r -> g \in gs /\ fits r g)) => r.
  have [rr|nr] := boolP (roots e r); last by exists ([::], (Z0, Z0, Z0)).
  by have [g] := fit r rr; exists g.
apply: (no_partitionP valid chosenP none (mem_head _ _)).
exists set0; split=> [r|| i|]; rewrite ?inE ?size_nseq ?big_set0 //.
by rewrite nth_nseq ltn_ord.
Qed.
End Soundness.

(** ** Every attack leaves a group that is worth the claim *)
Section Conclusions.
Local Open Scope ring_scope.
Variables (w : network) (S : Type) (start : S) (add : S -> nat -> S) (worth : S -> bool).
Variable (average_worth : S -> seq nat -> nat -> bool).
Hypothesis ok : network_ok w.
Local Notation robot := 'I_(top_robot w).+1.
Local Notation element := 'I_(top_element w).+1.
Variables (F : realFieldType) (phi : {set element} -> F) (p : {ffun robot -> element}) (lower : F).
Local Notation below := (fun i => (i < robots w)%N).
Hypotheses (worthP : worth_test start add phi p lower worth) (averageP : average_test start add phi p lower average_worth).
Variables (a : attack [finType of robot]) (l : sets_lemma).
Hypotheses (oka : allowed (team_of w) a) (sets : check_sets w start add worth average_worth l).
Local Notation near := (rows_of w (link_list w)).
Local Notation tied := (rows_of w (kept_links w)).

Lemma poor_groups : ~~ (lower <= team_value (team_of w) phi p a) ->
  forall i, ~~ (lower <= phi (contributed p (sees (team_of w) a i))).
Proof. by move=> low i; apply: contra low => h; apply: le_trans h (le_team_value (team_of w) phi p a i). Qed.

Theorem forced_setP i : (set_size l <= #|sees (team_of w) a i|)%N -> lower <= team_value (team_of w) phi p a.
Proof.
move=> many; apply: (@le_trans _ _ (phi (contributed p (sees (team_of w) a i)))); last exact: le_team_value.
exact: (check_setsP worthP averageP sets many).
Qed.

Theorem dualsP t : check_duals w start add worth average_worth (set_size l) near tied t ->
  lower <= team_value (team_of w) phi p a.
Proof.
move=> h; apply: contraLR (h) => /poor_groups poor; have good : tree_ok w start add worth average_worth near tied t by case/andP: h.
exact: (no_duals ok worthP averageP (fun V => check_setsP worthP averageP (V := V) sets) oka poor good).
Qed.

Theorem coverP t nodes : check_cover w start add worth average_worth (set_size l) near tied t nodes ->
  lower <= team_value (team_of w) phi p a.
Proof.
move=> h; apply: contraLR (h) => /poor_groups poor; have good : tree_ok w start add worth average_worth near tied t by case/andP: h.
exact: (no_cover ok worthP averageP (fun V => check_setsP worthP averageP (V := V) sets) oka poor good nodes).
Qed.
End Conclusions.
