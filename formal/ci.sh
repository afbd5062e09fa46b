#!/usr/bin/env bash
# Build formal/ from clean: installs Debian's packages where coqc is missing; fails, never skips.
set -euo pipefail
cd "$(dirname "$0")"
if ! command -v coqc >/dev/null || ! command -v ocamlfind >/dev/null; then
    as_root=()
    [ "$(id -u)" -eq 0 ] || as_root=(sudo)
    "${as_root[@]}" apt-get update -qq
    "${as_root[@]}" apt-get install -y -qq --no-install-recommends coq libcoq-mathcomp-algebra libcoq-mathcomp-zify \
        libcoq-mathcomp-algebra-tactics ocaml-nox ocaml-findlib libzarith-ocaml-dev
fi
make clean
make -j"$(nproc)" all
make -j"$(nproc)" check ratt-check
