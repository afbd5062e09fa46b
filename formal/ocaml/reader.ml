(* Translates a certificate file into the checker's data. Of this file, the statement depends on [problem] and [claim]
   only: proofs are hints that the checker decides. A JSON number stands for the binary64 float nearest to it. *)

module Big = Z
open Checker
open Json

exception Format of string
exception Fault of string

let format where rule = raise (Format (where ^ " " ^ rule))

let largest_index = 1_000_000
let table : nat array ref = ref [| O |]

(* Unary numbers, shared. *)
let nat_of_int k =
  if k < 0 || k > largest_index then format "an integer" "is out of range";
  let have = Array.length !table in
  if k >= have then begin
    let size = max (k + 1) (2 * have) in
    let fresh = Array.make size O in
    Array.blit !table 0 fresh 0 have;
    for i = have to size - 1 do fresh.(i) <- S fresh.(i - 1) done;
    table := fresh
  end;
  !table.(k)

let fields where names = function
  | Record pairs when List.sort compare (List.map fst pairs) = List.sort compare names ->
      List.map (fun name -> List.assoc name pairs) names
  | _ -> format where ("must be a record of " ^ String.concat ", " names)

let array where = function List l -> l | _ -> format where "must be a list"

let is_integer text = not (String.exists (fun c -> c = '.' || c = 'e' || c = 'E') text)

let integer where = function
  | Number text when is_integer text -> (match int_of_string_opt text with Some k -> k | None -> format where "is too large")
  | _ -> format where "must be an integer"

let index where value =
  let k = integer where value in
  if k < 0 then format where "must not be negative";
  k

let nat where value = nat_of_int (index where value)

(* Strictly ascending indices. *)
let indices where value =
  let found = List.map (index where) (array where value) in
  let rec ascending = function a :: (b :: _ as rest) -> a < b && ascending rest | _ -> true in
  if not (ascending found) then format where "must be strictly ascending";
  found

let nats where value = List.map nat_of_int (indices where value)

let links where value =
  let pair item = match indices where item with [ i; j ] -> (i, j) | _ -> format where "must hold pairs" in
  let found = List.map pair (array where value) in
  if List.length (List.sort_uniq compare found) < List.length found then format where "must not repeat a link";
  List.map (fun (i, j) -> (nat_of_int i, nat_of_int j)) found

(* [man / 2^sc], exactly. *)
let dyadic_of_float x =
  let fraction, exponent = Float.frexp x in
  let mantissa = Big.of_float (Float.ldexp fraction 53) in
  let exponent = exponent - 53 in
  if Big.equal mantissa Big.zero then { man = Big.zero; sc = Big.zero }
  else if exponent >= 0 then { man = Big.shift_left mantissa exponent; sc = Big.zero }
  else begin
    let drop = min (Big.trailing_zeros mantissa) (-exponent) in
    { man = Big.shift_right mantissa drop; sc = Big.of_int (-exponent - drop) }
  end

let exact where = function
  | Number text when is_integer text ->
      let value = Big.of_string text in
      if Big.gt (Big.abs value) (Big.shift_left Big.one 53) then format where "must be a number";
      { man = value; sc = Big.zero }
  | Number text ->
      let x = float_of_string text in
      if not (Float.is_finite x) then format "number" "must be finite";
      dyadic_of_float x
  | _ -> format where "must be a number"

let exacts where value = List.map (exact where) (array where value)

let objective = function
  | String "trace" -> Trace
  | String "maxeig" -> MaxEigenvalue
  | String "logdet" -> LogDet
  | _ -> raise (Fault "the objective must be trace, logdet or maxeig")

let problem value =
  let has name = match value with Record pairs -> List.mem_assoc name pairs | _ -> false in
  if has "at_most" then format "problem" "has at_most (few robots may be busy), which this checker does not know";
  let has_output = has "output" in
  let given =
    [ "objective"; "dimension"; "prior"; "information"; "weights"; "owners"; "links"; "alpha_s"; "alpha_c";
      "protected_robots"; "protected_links" ] in
  match fields "problem" (if has_output then given @ [ "output" ] else given) value with
  | kind :: d :: prior :: information :: weights :: owners :: pairs :: blinded :: cut :: safe_robots :: safe_links :: stated ->
      let kind = objective kind in
      let d = index "dimension" d in
      if d > 100 then format "dimension" "must be at most 100";
      let owners = List.map (index "owners") (array "owners" owners) in
      let top = List.fold_left max 0 owners in
      if top >= 1000 then format "owners" "must be below 1000";
      let size = List.length owners in
      let row value = List.map (exacts "information") (array "information" value) in
      let part value =
        let count = List.length (array "output" value) in
        if count = 0 || d = 0 || count mod d > 0 || count > d * d then
          format "output" "must hold rows of as many numbers as the dimension, and at most as many rows";
        exacts "output" value in
      let pb =
        { objective = kind; dimension = nat_of_int d; priors = List.map (exacts "prior") (array "prior" prior);
          weights = exacts "weights" weights;
          outputs = Option.map (fun all -> List.map part (array "output" all)) (List.nth_opt stated 0);
          informations = List.map row (array "information" information);
          net =
            { top_robot = nat_of_int top; owners = List.map nat_of_int owners; link_list = links "links" pairs;
              blind_budget = nat "alpha_s" blinded; cut_budget = nat "alpha_c" cut;
              kept_robots = nats "protected_robots" safe_robots; kept_links = links "protected_links" safe_links } } in
      if index "alpha_s" blinded > top + 1 || index "alpha_c" cut > List.length (array "links" pairs) then
        format "problem" "has a budget out of range";
      (pb, size)
  | _ -> assert false

let claim plan value =
  match fields "claim" [ "lower"; "upper" ] value with
  | [ low; high ] -> { plan = List.map (nat "plan") (array "plan" plan); lower = exact "claim" low; upper = exact "claim" high }
  | _ -> assert false

(* Trees are listed in preorder. *)
let consume name nodes build =
  let rest = ref nodes in
  let next () =
    match !rest with [] -> raise (Fault (name ^ " proof: a case has no leaf")) | node :: tail -> rest := tail; node in
  let tree = build next in
  if !rest <> [] then raise (Fault (name ^ " proof: a node is repeated or follows the last leaf"));
  tree

let deepest = 2500

(* [left]: the elements of each robot that the case leaves, in proofs with covers, where what a branch on a robot does not
   name is one part more; empty in others. [named]: the parts that the last branch on a robot names; a branch that names
   none has the same. *)
module Robots = Map.Make (Int)

(* A leaf's cuts or covers and their weights. *)
let weighed where numbers node =
  match fields where [ numbers; "weights" ] node with
  | [ chosen; weights ] ->
      let chosen = List.map (nat where) (array where chosen) and weights = exacts "leaf weights" weights in
      if List.length chosen <> List.length weights then format "leaf weights" "must be as many as it weighs";
      List.combine chosen weights
  | _ -> assert false

let rec in_order f = function [] -> [] | x :: rest -> let first = f x in first :: in_order f rest

let rec upper_node groups named left next depth =
  if depth > deepest then format "upper tree" "is too deep";
  let again left = upper_node groups named left next (depth + 1) in
  let rec children k = if k = 0 then [] else let first = again left in first :: children (k - 1) in
  match next () with
  | Record pairs as node when List.mem_assoc "covers" pairs -> CoverLeaf (weighed "cover leaf" "covers" node)
  | Record pairs as node when List.mem_assoc "marginals" pairs ->
      GainLeaf (match fields "marginal leaf" [ "marginals" ] node with [ a ] -> nat "marginal leaf" a | _ -> assert false)
  | Record pairs as node when List.mem_assoc "weights" pairs -> Leaf (weighed "leaf" "fenchel" node)
  | Record pairs as node when List.mem_assoc "part" pairs ->
      let a = match fields "part branch" [ "part" ] node with [ a ] -> index "part branch" a | _ -> assert false in
      if a >= Array.length groups then format "part branch" "names no attack";
      OnWinner (nat_of_int a, children groups.(a))
  | node ->
      let given = match node with Record pairs when not (List.mem_assoc "parts" pairs) -> [ "element" ] | _ -> [ "element"; "parts" ] in
      let given = fields "element branch" given node in
      let robot = index "element branch robot" (List.hd given) in
      List.iter (fun parts -> Hashtbl.replace named robot (List.map (indices "element branch") (array "parts" parts))) (List.tl given);
      let blocks =
        match Hashtbl.find_opt named robot with
        | Some blocks -> blocks
        | None -> format "element branch" "follows none that names the parts of its robot" in
      let before = Option.value (Robots.find_opt robot left) ~default:[] in
      let rest = List.filter (fun e -> not (List.exists (List.mem e) blocks)) before in
      let below block = let child = again (Robots.add robot block left) in (List.map nat_of_int block, child) in
      OnElement (nat_of_int robot, in_order below (if rest = [] then blocks else blocks @ [ rest ]))

(* Lower trees: names for leaves without a number, records of one field for the other nodes. [dear]: what the
   proof calls leaves of groups that cost too much; none in trees of sets, which branch on who senses alone. *)
let sets_only = ""

let rec case_node dear next depth =
  if depth > deepest then format "lower tree" "is too deep";
  let halves build = let first = case_node dear next (depth + 1) in build (first, case_node dear next (depth + 1)) in
  match next () with
  | String "worth" -> IsWorth
  | String "copies" -> CopiesWorth
  | String "budget" -> NoBudget
  | String "listed" -> IsListed
  | Record [ (name, value) ] -> (
      let k = nat ("lower tree " ^ name) value in
      let none () = raise (Fault ("lower proof: a node is none of this proof: " ^ name)) in
      match name with
      | "sense" -> halves (fun (a, b) -> Sense (k, a, b))
      | "limit" -> Limited (k, case_node dear next (depth + 1))
      | _ when name = dear -> Dear k
      | _ when dear = sets_only -> none ()
      | "inside" -> halves (fun (a, b) -> Inside (k, a, b))
      | "sensing" -> halves (fun (a, b) -> Sensing (k, a, b))
      | "blinded" -> halves (fun (a, b) -> Blinding (k, a, b))
      | _ -> none ())
  | _ -> raise (Fault "lower proof: a node must be a name, or a record of one")

let case_tree dear value = consume "lower" (array "lower tree" value) (fun next -> case_node dear next 0)

(* Integers below 2^53 in size, or another power. *)
let signed ?(bits = 53) where value =
  let k = integer where value in
  if k >= 1 lsl bits || k <= -(1 lsl bits) then format where "is too large";
  Big.of_int k

let unsigned ?(bits = 53) where value =
  let k = signed ~bits where value in
  if Big.sign k < 0 then format where "must not be negative";
  k

let sets value =
  match fields "sets" [ "size"; "tree" ] value with
  | [ size; tree ] -> { set_size = nat "sets size" size; set_tree = case_tree sets_only tree }
  | _ -> assert false

let prices value =
  match fields "duals" [ "link"; "robots"; "blinded" ] value with
  | [ link; robots; blinded ] ->
      { link_price = unsigned "duals link" link; robot_prices = List.map (fun x -> signed "duals robots" x) (array "duals robots" robots);
        blind_price = unsigned "duals blinded" blinded }
  | _ -> assert false

let rec int_of_nat = function O -> 0 | S k -> 1 + int_of_nat k

(* Flows, given for each link in ascending order, as rows of what each robot sends to each. *)
let flow_bound net value =
  match fields "bound" [ "blinding"; "cut"; "flow" ] value with
  | [ blinding; cut; flow ] ->
      let pairs = List.sort compare (List.map (fun (i, j) -> (int_of_nat i, int_of_nat j)) net.link_list) in
      let amounts = List.map (fun x -> signed "bound flow" x) (array "bound flow" flow) in
      if List.length amounts <> List.length pairs then format "bound flow" "must have an entry for each link";
      let n = int_of_nat net.top_robot + 1 in
      let rows = Array.make_matrix n n Big.zero in
      let carry (i, j) amount =
        if j >= n then format "links" "name a robot that owns nothing";
        rows.(i).(j) <- amount;
        rows.(j).(i) <- Big.neg amount in
      List.iter2 carry pairs amounts;
      { more_blind = unsigned "bound blinding" blinding; more_cut = unsigned "bound cut" cut;
        carried = Array.to_list (Array.map Array.to_list rows) }
  | _ -> assert false

let limit net value =
  match fields "limit" [ "robots"; "size"; "tree" ] value with
  | [ robots; size; tree ] ->
      let members = indices "limit robots" robots and n = int_of_nat net.top_robot + 1 in
      if List.exists (fun i -> i >= n) members then format "limit robots" "names no robot";
      { limited = List.init n (fun i -> List.mem i members); limit_lemma = sets (Record [ ("size", size); ("tree", tree) ]) }
  | _ -> assert false

let group_tree net limits duals bounds tree =
  { dual = prices duals; bounds = List.map (flow_bound net) (array "bounds" bounds);
    limits = List.map (limit net) limits; groups = case_tree "flow" tree }

(* Integers below 2^31 in size, as many as there are robots. *)
let small_integers where net value =
  let found = List.map (fun x -> signed ~bits:31 where x) (array where value) in
  if List.length found <> int_of_nat net.top_robot + 1 then format where "must have an entry for each robot";
  found

let size_proof net duals forms bounds trees =
  if int_of_nat net.top_robot + 1 > 200 then format "lower proof" "by sizes is for at most 200 robots";
  let vector value =
    match fields "duals" [ "link"; "robots" ] value with
    | [ link; robots ] ->
        { link_price = unsigned ~bits:31 "duals link" link; robot_prices = small_integers "duals robots" net robots; blind_price = Big.zero }
    | _ -> assert false in
  let form value =
    match fields "form" [ "duals"; "robots"; "least"; "diagonal" ] value with
    | [ number; robots; least; diagonal ] ->
        { form_prices = nat "form duals" number; form_robots = nat "form robots" robots;
          form_least = signed ~bits:31 "form least" least; form_diagonal = small_integers "form diagonal" net diagonal }
    | _ -> assert false in
  let bound value =
    match fields "bound" [ "duals"; "diagonal" ] value with
    | [ number; diagonal ] -> (nat "bound duals" number, small_integers "bound diagonal" net diagonal)
    | _ -> assert false in
  { vectors = List.map vector (array "duals" duals); forms = List.map form (array "forms" forms);
    diagonals = List.map bound (array "bounds" bounds); group_trees = List.map (case_tree "form") (array "trees" trees) }

let lower_proof net value =
  let pairs = match value with Record pairs -> pairs | _ -> [] in
  let conclusion = List.assoc_opt "conclusion" pairs in
  let given names = fields "lower proof" ("conclusion" :: names) value in
  let limited = if List.mem_assoc "limits" pairs then [ "limits" ] else [] in
  let known = List.concat_map (array "limits") in
  match conclusion with
  | Some (String "enumerated") -> ignore (given []); NoLower
  | Some (String "forced") -> (match given [ "sets" ] with [ _; l ] -> ForcedSets (sets l) | _ -> assert false)
  | Some (String "duals") -> (
      match given ([ "sets"; "duals"; "bounds"; "tree" ] @ limited) with
      | _ :: l :: duals :: bounds :: tree :: limits -> Duals (sets l, group_tree net (known limits) duals bounds tree)
      | _ -> assert false)
  | Some (String "cover") -> (
      match given ([ "sets"; "duals"; "bounds"; "tree"; "partition" ] @ limited) with
      | _ :: l :: duals :: bounds :: tree :: partition :: limits ->
          Cover (sets l, group_tree net (known limits) duals bounds tree, List.map (nat "partition") (array "partition" partition))
      | _ -> assert false)
  | Some (String "sizes") -> (
      match given [ "sets"; "duals"; "forms"; "bounds"; "trees" ] with
      | [ _; l; duals; forms; bounds; trees ] -> GroupSizes (sets l, size_proof net duals forms bounds trees)
      | _ -> assert false)
  | _ -> raise (Fault "lower proof: the conclusion must be forced, duals, cover, sizes or enumerated")

let attack value =
  match fields "attack" [ "robots"; "links" ] value with
  | [ robots; pairs ] -> (nats "attack robots" robots, links "attack links" pairs)
  | _ -> assert false

let exacts_of_length where length value =
  let found = exacts where value in
  if List.length found <> length then format where (Printf.sprintf "must be a list of %d entries" length);
  found

let point pb value =
  let d = int_of_nat pb.dimension in
  match (pb.objective, value) with
  | (Trace | LogDet), _ ->
      (* As many entries as the output: [d] rows, with a column for each of its rows. *)
      let lengths = match pb.outputs with Some parts -> List.map List.length parts | None -> List.map (fun _ -> d * (d + 1) / 2) pb.priors in
      let given = array "point" value in
      if List.length given <> List.length lengths then format "point" "must have a matrix for each target";
      TracePoint (List.map2 (exacts_of_length "point Y") lengths given)
  | MaxEigenvalue, List [ target; size; direction ] ->
      EigenPoint (nat "point target" target, exact "point t" size, exacts_of_length "point v" d direction)
  | _ -> format "point" "must be a list of 3 entries"

(* The tangent of one target: as a point, of that target alone. *)
let tangent pb value =
  let d = int_of_nat pb.dimension in
  match (pb.objective, array "tangent" value) with
  | (Trace | LogDet), [ target; y ] ->
      let j = index "tangent target" target in
      if j >= List.length pb.priors then format "tangent target" "names no target";
      let length = match pb.outputs with Some parts -> List.length (List.nth parts j) | None -> d * (d + 1) / 2 in
      (nat_of_int j, MatrixTouch (exacts_of_length "tangent Y" length y))
  | MaxEigenvalue, [ target; size; direction ] ->
      (nat "tangent target" target, EigenTouch (exact "tangent t" size, exacts_of_length "tangent v" d direction))
  | _ -> format "tangent" "must be a list of two entries, of three for maxeig"

(* A lemma's tree: what a branch does not name is one part more, with the option of no element, numbered as the elements. *)
let lemma pb owned size stated extra value =
  match fields "lemma" [ "target"; "elements"; "scores"; "constant"; "tree" ] value with
  | [ target; elements; scores; constant; tree ] ->
      let elements = indices "lemma elements" elements and given = exacts "lemma scores" scores in
      if List.length elements <> List.length given then format "lemma scores" "must be as many as its elements";
      let dense = Array.make size { man = Big.zero; sc = Big.zero } in
      List.iter2 (fun e x -> if e >= size then format "lemma elements" "names no element" else dense.(e) <- x) elements given;
      let target = nat "lemma target" target in
      (* A base set at a leaf is one more tangent, behind those that the file states. *)
      let base members =
        if pb.objective <> LogDet then raise (Fault "upper proof: gains diminish with the log-det alone");
        if List.exists (fun e -> e >= size) members then format "lemma leaf base" "names no element";
        let number = stated + List.length !extra in
        extra := (target, BaseTouch (List.map nat_of_int members)) :: !extra;
        LemmaLeaf (nat_of_int number) in
      let rec node left next depth =
        if depth > deepest then format "lemma tree" "is too deep";
        match next () with
        | Number _ as leaf ->
            let k = index "lemma leaf" leaf in
            if k >= stated then format "lemma leaf" "names no tangent";
            LemmaLeaf (nat_of_int k)
        | Record [ ("base", members) ] -> base (indices "lemma leaf base" members)
        | branch -> (
            match fields "lemma branch" [ "element"; "parts" ] branch with
            | [ robot; parts ] ->
                let i = index "lemma branch robot" robot in
                let blocks = List.map (indices "lemma branch") (array "lemma branch parts" parts) in
                let before = Option.value (Robots.find_opt i left) ~default:[] in
                let rest = List.filter (fun e -> not (List.exists (List.mem e) blocks)) before in
                let below block = let child = node (Robots.add i block left) next (depth + 1) in (List.map nat_of_int block, child) in
                LemmaBranch (nat_of_int i, in_order below (if rest = [] then blocks else blocks @ [ rest ]))
            | _ -> assert false) in
      { lemma_target = target; lemma_scores = Array.to_list dense; lemma_constant = exact "lemma constant" constant;
        lemma_proof = consume "lemma" (array "lemma tree" tree) (fun next -> node (Robots.map (fun own -> own @ [ size ]) owned) next 0) }
  | _ -> assert false

(* Rows name what differs from the usual inequalities; here each is written out, by target. *)
let rows pb size owned given =
  let field name = Option.value (List.assoc_opt name given) ~default:(List []) in
  let tangents = List.map (tangent pb) (array "tangents" (field "tangents")) in
  let stated = List.length tangents and extra = ref [] in
  let lemmas = in_order (lemma pb owned size stated extra) (array "lemmas" (field "lemmas")) in
  let bases = List.rev !extra in
  let moved k = nat_of_int (if k < stated then k else k + List.length bases) in
  let targets = Array.of_list (List.map (fun (j, _) -> int_of_nat j) tangents @ List.map (fun l -> int_of_nat l.lemma_target) lemmas) in
  let by_target where numbers =
    let add found k =
      if k >= Array.length targets then format where "names no inequality";
      if Robots.mem targets.(k) found then raise (Fault ("upper proof: " ^ where ^ " names two inequalities of a target"));
      Robots.add targets.(k) k found in
    List.fold_left add Robots.empty (List.map (index where) (array where numbers)) in
  let usual = by_target "usual" (field "usual") in
  let row value =
    match array "row" value with
    | [ a; g; numbers ] ->
        let named = by_target "row" numbers in
        let whole = if pb.objective = MaxEigenvalue then named else Robots.union (fun _ k _ -> Some k) named usual in
        ((nat "row attack" a, nat "row group" g), List.map (fun (_, k) -> moved k) (Robots.bindings whole))
    | _ -> format "row" "must be a list of 3 entries" in
  let spacing value =
    if pb.objective <> Trace then raise (Fault "upper proof: this checker reads the spacing of values for the trace only");
    match fields "spacing" [ "count"; "lemmas" ] value with
    | [ count; numbers ] -> (nat "spacing count" count, List.map (nat "spacing lemmas") (array "spacing lemmas" numbers))
    | _ -> assert false in
  { tangent_list = tangents @ bases; lemma_list = lemmas; row_list = List.map row (array "rows" (field "rows"));
    spacing = Option.map spacing (List.assoc_opt "spacing" given) }

let cut value =
  match array "cut" value with
  | [ a; g; k ] -> ((nat "cut attack" a, nat "cut group" g), nat "cut point" k)
  | _ -> format "cut" "must be a list of 3 entries"

let cover size value =
  match fields "cover" [ "attack"; "left_out"; "points" ] value with
  | [ a; out; points ] ->
      let out = indices "cover left_out" out in
      if List.exists (fun e -> e >= size) out then format "cover left_out" "names no element";
      ((nat "cover attack" a, List.map nat_of_int out), List.map (nat "cover point") (array "cover points" points))
  | _ -> assert false

let proofs pb size prior_range upper lower =
  let stated = match upper with Record pairs -> pairs | _ -> [] in
  let optional = List.filter (fun name -> List.mem_assoc name stated) [ "covers"; "tangents"; "lemmas"; "usual"; "rows"; "spacing" ] in
  let has_covers = List.mem "covers" optional in
  match fields "upper proof" ([ "attacks"; "points"; "cuts"; "tree" ] @ optional) upper with
  | attacks :: points :: cuts :: tree :: _ ->
      let covers = Option.to_list (List.assoc_opt "covers" stated) in
      let listed = List.map attack (array "attacks" attacks) in
      let arity a = if attack_ok pb.net a then List.length (seeing_groups pb.net a) else raise (Fault "upper proof: an attack is not allowed") in
      let groups = Array.of_list (List.map arity listed) and named = Hashtbl.create 16 in
      let add left (e, robot) = Robots.update robot (fun own -> Some (Option.value own ~default:[] @ [ e ])) left in
      let owned = List.mapi (fun e robot -> (e, int_of_nat robot)) pb.net.owners in
      let owned = List.fold_left add Robots.empty owned in
      let left = if has_covers then owned else Robots.empty in
      let zero = { man = Big.zero; sc = Big.zero } in
      let low, high =
        match (pb.objective, exacts "prior_eigenvalue" prior_range) with
        | (Trace | LogDet), [] -> (zero, zero)
        | MaxEigenvalue, [ low; high ] -> (low, high)
        | _ -> format "prior_eigenvalue" "must be a list of two entries, of none but for maxeig" in
      { prior_low = low; prior_high = high; listed; points = List.map (point pb) (array "points" points);
        cut_list = List.map cut (array "cuts" cuts);
        cover_list = List.concat_map (fun found -> List.map (cover size) (array "covers" found)) covers;
        upper_part = consume "upper" (array "upper tree" tree) (fun next -> upper_node groups named left next 0);
        lower_part = lower; rows_part = rows pb size owned stated }
  | _ -> assert false

(* What the problem is said to be made from: no statement depends on it. *)
let without_origin = function
  | Record pairs when List.mem_assoc "made_from" pairs ->
      let is_digit c = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') in
      (match List.assoc "made_from" pairs with
      | String text when String.length text = 64 && String.for_all is_digit text -> Record (List.remove_assoc "made_from" pairs)
      | _ -> format "made_from" "must be a SHA-256 of 64 lower-case hexadecimal digits")
  | document -> document

let certificate document =
  match
    fields "certificate" [ "format"; "version"; "problem"; "plan"; "claim"; "prior_eigenvalue"; "upper"; "lower" ] (without_origin document)
  with
  | [ String "ratt-opt certificate"; Number "2"; stated; plan; claimed; prior_range; upper; lower ] ->
      let pb, size = problem stated in
      let lower = lower_proof pb.net lower in
      (pb, claim plan claimed, proofs pb size prior_range upper lower)
  | _ -> format "certificate" "must be version 2 of a ratt-opt certificate"
