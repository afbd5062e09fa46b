(* ratt-check FILE ...: decide certificates with the checker extracted from its Coq proof.
   Exit status of the worst file: 0 both ends proved, 3 only the upper end, 1 a fault, 2 no certificate. *)

let largest_file = 32 * 1024 * 1024

let read path =
  let channel = open_in_bin path in
  let size = in_channel_length channel in
  if size > largest_file then raise (Reader.Format "file is too large");
  let text = really_input_string channel size in
  close_in channel;
  text

(* The claim's numbers are floats, so nothing is lost here. *)
let shown (x : Checker.dyadic) = Float.ldexp (Z.to_float x.man) (-Z.to_int x.sc)

let decide path =
  try
    let pb, cl, pr = Reader.certificate (Json.parse (read path)) in
    match Checker.check pb cl pr with
    | Checker.Proved -> (0, Printf.sprintf "both ends proved: %.17g <= optimum <= %.17g" (shown cl.lower) (shown cl.upper))
    | Checker.UpperOnly -> (3, Printf.sprintf "only the upper end proved: optimum <= %.17g" (shown cl.upper))
    | Checker.Refused -> (1, "not proved")
  with
  | Reader.Fault text -> (1, text)
  | Reader.Format text | Json.Bad text | Sys_error text | Failure text | Invalid_argument text -> (2, text)
  | Stack_overflow | Out_of_memory -> (2, "the file takes too much memory")

let rank = function 0 -> 0 | 3 -> 1 | 1 -> 2 | _ -> 3

let () =
  let files = List.tl (Array.to_list Sys.argv) in
  if files = [] then (prerr_endline "usage: ratt-check CERTIFICATE ..."; exit 2);
  let decided = List.map (fun file -> let code, text = decide file in Printf.printf "%d %s: %s\n%!" code file text; code) files in
  exit (List.fold_left (fun worst code -> if rank code > rank worst then code else worst) 0 decided)
