(** Lower proofs by sizes: an attack blinds as many robots as it may; what its groups cost by their sizes alone says how
    many robots of the largest one sense and are blinded; a tree shows that such a group is worth the claim or costs more. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify ssrZ.
From Ratt Require Import Extrema Teams Graph CaseTree Costs AttackGroups GroupProofs Positive.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** Groups of [form_robots] robots cost at least [form_least] by one vector of prices. *)
Record size_form := SizeForm { form_prices : nat; form_robots : nat; form_least : Z; form_diagonal : seq Z }.
Record size_proof := SizeProof {
  vectors : seq prices; forms : seq size_form; diagonals : seq (nat * seq Z); group_trees : seq case_tree
}.

(** Numbers, or [None] for infinity. *)
Definition omin (x y : option Z) : option Z :=
  match x, y with Some a, Some b => Some (Z.min a b) | Some _, None => x | _, _ => y end.
Definition omax (x y : option Z) : option Z :=
  match x, y with Some a, Some b => Some (Z.max a b) | _, _ => None end.
Definition oadd (x y : option Z) : option Z :=
  match x, y with Some a, Some b => Some (Z.add a b) | _, _ => None end.
Definition ole (x y : option Z) : bool :=
  match x, y with Some a, Some b => Z.leb a b | _, None => true | None, _ => false end.

(** The [k] smallest numbers. *)
Definition smallest_sum (k : nat) (s : seq Z) : Z :=
  let t := nth Z0 (sort Z.leb s) k.-1 in
  Z.add (zsum [seq Z.min Z0 (Z.sub x t) | x <- s]) (Z.mul (Z.of_nat k) t).

(** Units of diagonals. *)
Definition unit_of : Z := 1024.

Section Costs.
Variables (w : network) (near : seq (seq bool)) (d : prices).
Local Notation n := (robots w).
Local Notation h := (link_price d).

(** What a robot costs if all of its links leave the group. *)
Definition charges : seq Z :=
  [seq Z.sub (Z.mul h (Z.of_nat (count id x.1))) x.2 | x <- zip near (robot_prices d)].
Definition most_cost : option Z :=
  if all (Z.eqb Z0) (robot_prices d) then Some (Z.mul h (Z.of_nat (cut_budget w))) else None.
(** A bound on costs that no group of an attack can have is infinite. *)
Definition left_cost (x : Z) : option Z := if ole (Some x) most_cost then Some x else None.
Definition cost_by_size (s : nat) : Z :=
  Z.sub (smallest_sum s charges) (Z.mul h (Z.of_nat (minn (s * s.-1) (size (link_list w) + size (link_list w))))).
Definition first_least : seq (option Z) := [seq left_cost (cost_by_size s) | s <- iota 0 n.+1].
Definition step : Z := foldr Z.gcd (Z.add h h) charges.
Definition round_up (x : Z) : Z := Z.opp (Z.mul (Z.div (Z.opp x) step) step).

(** Sums over the links of one row to robots of a mask. *)
Definition links_to (row mask : seq bool) : Z := Z.of_nat (count (fun x => x.1 && x.2) (zip row mask)).
Definition room_of (limit : Z) (ins : seq bool) : Z :=
  Z.sub (zsum [seq if x.1 then Z.sub x.2.1 (Z.mul h (links_to x.2.2 ins)) else Z0 | x <- zip ins (zip charges near)]) limit.

(** Rows of the form for the robots [os], the first for the constant. *)
Definition form_row (diagonal : seq Z) (ins : seq bool) (os : seq nat) (i : nat) : seq Z :=
  let row := nth [::] near i in
  let u := nth Z0 diagonal i in
  let slope := Z.sub (Z.mul unit_of (Z.sub (nth Z0 charges i) (Z.mul (Z.add h h) (links_to row ins)))) u in
  slope :: [seq Z.sub (if j == i then Z.add u u else Z0)
              (if nth false row j then Z.mul unit_of (Z.add h h) else Z0) | j <- os].
Definition form_matrix (room : Z) (diagonal : seq Z) (ins : seq bool) (os : seq nat) : zmat :=
  let rows := [seq form_row diagonal ins os i | i <- os] in
  (Z.mul (Z.add unit_of unit_of) room :: [seq head Z0 row | row <- rows]) :: rows.
(** The last robot is written by the others, as [k] of them are in the group. *)
Definition last_coefficient (k : Z) (a : nat) : Z := if a is 0 then k else Zneg xH.
Definition reduced (m : nat) (k : Z) (A : zmat) : zmat :=
  let last := nth [::] A m in
  [seq (let row := nth [::] A a in
        let e := last_coefficient k a in
        let v := nth Z0 row m in
        [seq Z.add (Z.add (nth Z0 row b) (Z.mul v (last_coefficient k b)))
               (Z.mul e (Z.add (nth Z0 last b) (Z.mul (last_coefficient k b) (nth Z0 last m)))) | b <- iota 0 m])
   | a <- iota 0 m].

(** Whether the robots inside and any [k] of the others cost more than the limit. *)
Definition is_above (limit : Z) (diagonal : seq Z) (ins others : seq bool) (k : Z) : bool :=
  let m := count id others in
  let all_in := Z.eqb k (Z.of_nat m) in
  let ins' := if all_in then [seq x.1 || x.2 | x <- zip ins others] else ins in
  let k' := if all_in then Z0 else k in
  let room := room_of limit ins' in
  if Z.ltb Z0 k' && Z.ltb k' (Z.of_nat m) then
    let os := [seq i <- iota 0 n | nth false others i] in
    positive m (reduced m k' (form_matrix room diagonal ins' os)) (Zpos xH)
  else ~~ Z.eqb k' Z0 || Z.ltb Z0 room.

Definition raised (least : seq (option Z)) (f : size_form) : option (seq (option Z)) :=
  if [&& (form_robots f <= n)%N, size (form_diagonal f) == n
      & is_above (Z.pred (form_least f)) (form_diagonal f) (nseq n false) (nseq n true) (Z.of_nat (form_robots f))] then
    Some (set_nth None least (form_robots f) (omax (nth None least (form_robots f)) (left_cost (round_up (form_least f)))))
  else None.

(** *** What other groups cost at least *)
(** Rows: how many of their robots sense; columns: how many are blinded. From what groups of fewer sensing robots
    cost, adds those of [a] sensing ones. *)
Variables (least : seq (option Z)) (sense blind : nat).
Fixpoint own_row (old : seq (option Z)) (before : seq (option Z)) : seq (option Z) :=
  if old is x :: old' then
    let joined := [seq oadd y.1 y.2 | y <- zip before (behead least)] in
    let new := foldr omin x joined in new :: own_row old' (new :: before)
  else [::].
Definition joined_row (a : nat) (old fewer : seq (option Z)) : seq (option Z) :=
  [seq foldr omin x.1 [seq oadd (nth None fewer (x.2 - y)) (nth None least (a + y)) | y <- iota 0 x.2.+1]
  | x <- zip old (iota 0 (size old))].
Fixpoint next_rows (a : nat) (old done : seq (seq (option Z))) : seq (seq (option Z)) :=
  if old is row :: old' then
    let new := if a is 0 then own_row row [::] else if a <= size done then joined_row a row (nth [::] done a.-1) else row in
    new :: next_rows a old' (new :: done)
  else [::].
Definition first_rows : seq (seq (option Z)) :=
  mkseq (fun c => mkseq (fun x => if (c == 0%N) && (x == 0%N) then Some Z0 else None) blind.+1) sense.+1.
Fixpoint other_rows (a : nat) : seq (seq (option Z)) :=
  if a is a'.+1 then next_rows a (other_rows a') [::] else next_rows 0 first_rows [::].
Fixpoint all_other_rows (k : nat) (a : nat) (old : seq (seq (option Z))) : seq (seq (seq (option Z))) :=
  if k is k'.+1 then let new := next_rows a old [::] in new :: all_other_rows k' a.+1 new else [::].
(** The table is right: adding a group of at most [a] sensing robots makes no entry too large. *)
Definition closed_rows (a : nat) (rows : seq (seq (option Z))) : bool :=
  [&& size rows == sense.+1, all (fun row => size row == blind.+1) rows, ole (nth None (nth [::] rows 0) 0) (Some Z0)
    & all (fun a' => all (fun y => (a' + y == 0)%N ||
        let l := nth None least (a' + y) in
        all (fun r => all (fun x => ole x.1 (oadd x.2 l)) (zip (drop y r.1) r.2)) (zip (drop a' rows) rows))
      (iota 0 blind.+1)) (iota 0 a.+1)].
End Costs.

Section Checker.
Variables (w : network) (S : Type) (start : S) (add : S -> nat -> S) (worth : S -> bool).
Variable (average_worth : S -> seq nat -> nat -> bool).
Variables (near tied : seq (seq bool)) (size_k : nat) (t : size_proof).
Local Notation n := (robots w).
Local Notation sense := (n - spare w)%N.
Local Notation blind := (spare w).

Definition no_prices : prices := Prices Z0 [::] Z0.
Definition vectors_ok : bool :=
  (0 < size (vectors t))%N && all (fun d => prices_ok w d && Z.eqb (blind_price d) Z0) (vectors t).
Definition first_tables : seq (seq (option Z)) := [seq first_least w near d | d <- vectors t].
Fixpoint tables (fs : seq size_form) (found : seq (seq (option Z))) : option (seq (seq (option Z))) :=
  if fs is f :: fs' then
    if (form_prices f < size found)%N then
      if raised w near (nth no_prices (vectors t) (form_prices f)) (nth [::] found (form_prices f)) f is Some new then
        tables fs' (set_nth [::] found (form_prices f) new)
      else None
    else None
  else Some found.

(** By vector: [least], and what the others cost at least for each number of sensing robots of the largest group. *)
Definition others_of (least : seq (option Z)) : seq (seq (seq (option Z))) :=
  all_other_rows least (minn size_k sense.+1) 0 (first_rows sense blind).
Definition others_ok (least : seq (option Z)) (levels : seq (seq (seq (option Z)))) : bool :=
  all (fun a => closed_rows least sense blind a (nth [::] levels a)) (iota 0 (minn size_k sense.+1)).
Definition limit_of (d : prices) (levels : seq (seq (seq (option Z)))) (a b : nat) : option Z :=
  if nth None (nth [::] (nth [::] levels a) (sense - a)) (blind - b) is Some x then
    omin (Some (Z.sub (slack w d) x)) (most_cost w d)
  else None.
(** A vector, its least costs, and those of other groups. *)
Definition known_costs := (prices * seq (option Z) * seq (seq (seq (option Z))))%type.
Definition limits (ks : seq known_costs) (a b : nat) : seq (option Z) := [seq limit_of k.1.1 k.2 a b | k <- ks].
Definition is_possible (ks : seq known_costs) (a b : nat) : bool :=
  all (fun k => match nth None k.1.2 (a + b), limit_of k.1.1 k.2 a b with Some x, Some y => Z.leb x y | _, _ => false end) ks.
Definition largest_groups (ks : seq known_costs) : seq (nat * nat) :=
  [seq ab <- [seq (a, b) | a <- iota 0 (minn size_k sense.+1), b <- iota 0 blind.+1] | is_possible ks ab.1 ab.2].

Definition size_case (a b : nat) : case S :=
  Case start 0 (Z.of_nat a) (Z.of_nat a) (Z.of_nat b) (Z.of_nat b) [seq Options true (i \notin kept_robots w) true | i <- iota 0 n].
Definition is_costly (ls : seq (option Z)) (robots_in : nat) (k : nat) (c : case S) : bool :=
  if drop k (diagonals t) is (j, diagonal) :: _ then
    if nth None ls j is Some limit then
      (j < size (vectors t))%N && (size diagonal == n) &&
      is_above w near (nth no_prices (vectors t) j) limit diagonal [seq inside o | o <- options c]
        [seq ~~ inside o && ~~ gone o | o <- options c] (Z.sub (Z.of_nat robots_in) (Z.of_nat (count_inside c)))
    else false
  else false.
Definition check_group (ks : seq known_costs) (ab : nat * nat) (tree : case_tree) : bool :=
  if check_cases add worth average_worth (fun _ _ => None) (@beyond_budgets w near tied S) (is_costly (limits ks ab.1 ab.2) (ab.1 + ab.2))
       (fun _ => None : option (option unit)) tree (size_case ab.1 ab.2) [::] is Some _ then true else false.
Fixpoint check_groups (ks : seq known_costs) (gs : seq (nat * nat)) (trees : seq case_tree) : bool :=
  match gs, trees with
  | g :: gs', tree :: trees' => check_group ks g tree && check_groups ks gs' trees'
  | [::], [::] => true
  | _, _ => false
  end.
Definition check_group_sizes : bool :=
  vectors_ok && all (fun b => (b.1 < size (vectors t))%N && (size b.2 == n)) (diagonals t) &&
  if tables (forms t) first_tables is Some leasts then
    let ks := [seq (x.1, x.2, others_of x.2) | x <- zip (vectors t) leasts] in
    all (fun k => others_ok k.1.2 k.2) ks && check_groups ks (largest_groups ks) (group_trees t)
  else false.
End Checker.
