(* Strict JSON, as much of it as certificates use. Numbers keep their text. *)

type t =
  | Null
  | Bool of bool
  | Number of string
  | String of string
  | List of t list
  | Record of (string * t) list

exception Bad of string

let bad where = raise (Bad ("not JSON: " ^ where))

let parse (s : string) : t =
  let n = String.length s in
  let pos = ref 0 in
  let rec skip () =
    if !pos < n then match s.[!pos] with ' ' | '\t' | '\n' | '\r' -> incr pos; skip () | _ -> () in
  let expect c = if !pos < n && s.[!pos] = c then incr pos else bad (Printf.sprintf "expected %c at byte %d" c !pos) in
  let word w value =
    let k = String.length w in
    if !pos + k <= n && String.sub s !pos k = w then (pos := !pos + k; value) else bad "a word" in
  let digits () =
    let from = !pos in
    while !pos < n && s.[!pos] >= '0' && s.[!pos] <= '9' do incr pos done;
    if !pos = from then bad "a digit is missing" in
  let number () =
    let from = !pos in
    if s.[!pos] = '-' then incr pos;
    let first = !pos in
    digits ();
    if s.[first] = '0' && !pos > first + 1 then bad "a number begins with 0";
    if !pos < n && s.[!pos] = '.' then (incr pos; digits ());
    if !pos < n && (s.[!pos] = 'e' || s.[!pos] = 'E') then begin
      incr pos;
      if !pos < n && (s.[!pos] = '+' || s.[!pos] = '-') then incr pos;
      digits ()
    end;
    Number (String.sub s from (!pos - from)) in
  (* Certificates need no escapes in their fixed words; a text with one is some other text. *)
  let text () =
    expect '"';
    let b = Buffer.create 16 in
    let rec go () =
      if !pos >= n then bad "a text does not end";
      match s.[!pos] with
      | '"' -> incr pos
      | '\\' -> if !pos + 1 >= n then bad "a text does not end"; Buffer.add_string b (String.sub s !pos 2); pos := !pos + 2; go ()
      | c when Char.code c < 32 -> bad "a control character"
      | c -> Buffer.add_char b c; incr pos; go () in
    go ();
    Buffer.contents b in
  let rec value depth =
    if depth > 900 then bad "nested too deep";
    skip ();
    if !pos >= n then bad "it ends too early";
    match s.[!pos] with
    | '{' -> incr pos; Record (members depth [])
    | '[' -> incr pos; List (items depth [])
    | '"' -> String (text ())
    | 't' -> word "true" (Bool true)
    | 'f' -> word "false" (Bool false)
    | 'n' -> word "null" Null
    | '-' | '0' .. '9' -> number ()
    | c -> bad (Printf.sprintf "%C at byte %d" c !pos)
  and items depth found =
    skip ();
    if found = [] && !pos < n && s.[!pos] = ']' then (incr pos; [])
    else begin
      let found = value (depth + 1) :: found in
      skip ();
      if !pos < n && s.[!pos] = ',' then (incr pos; items depth found) else (expect ']'; List.rev found)
    end
  and members depth found =
    skip ();
    if found = [] && !pos < n && s.[!pos] = '}' then (incr pos; [])
    else begin
      skip ();
      let name = text () in
      if List.mem_assoc name found then bad ("the field " ^ name ^ " is repeated");
      skip ();
      expect ':';
      let found = (name, value (depth + 1)) :: found in
      skip ();
      if !pos < n && s.[!pos] = ',' then (incr pos; members depth found) else (expect '}'; List.rev found)
    end in
  let found = value 0 in
  skip ();
  if !pos < n then bad "something follows the document";
  found
