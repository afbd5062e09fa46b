#!/usr/bin/env bash
# Build formal/ from clean: installs Debian's packages where one is missing; fails, never skips.
set -euo pipefail
cd "$(dirname "$0")"
packages=(coq libcoq-mathcomp-algebra libcoq-mathcomp-zify libcoq-mathcomp-algebra-tactics ocaml-nox ocaml-findlib
    libzarith-ocaml-dev make)

have_all() {
    command -v coqc >/dev/null && command -v make >/dev/null && ocamlfind query zarith >/dev/null 2>&1 &&
        [ -e "$(coqc -where)/user-contrib/mathcomp/algebra/ssralg.vo" ] &&
        [ -e "$(coqc -where)/user-contrib/mathcomp/zify/ssrZ.vo" ] &&
        [ -e "$(coqc -where)/user-contrib/mathcomp/algebra_tactics/ring.vo" ]
}

if ! have_all; then
    as_root=()
    [ "$(id -u)" -eq 0 ] || as_root=(sudo)
    "${as_root[@]}" apt-get update -qq
    "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${packages[@]}"
fi
have_all || { echo "formal/: a package is missing"; exit 1; }
make clean
make -j"$(nproc)" all
make -j"$(nproc)" check ratt-check
