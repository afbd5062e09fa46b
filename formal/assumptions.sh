#!/usr/bin/env bash
# assumptions.sh QUERIES OUTPUT: fail unless every "Print Assumptions" of QUERIES was answered "Closed under the global context".
set -euo pipefail
asked=$(grep -c '^Print Assumptions ' "$1")
closed=$(grep -c '^Closed under the global context$' "$2" || true)
if [ "$asked" -eq 0 ] || [ "$asked" -ne "$closed" ] || [ "$(wc -l < "$2")" -ne "$asked" ]; then
    echo "$closed of $asked theorems are closed under the global context:"
    cat "$2"
    exit 1
fi
if grep -nE '\b(Admitted|admit|Axiom|Axioms|Parameter|Parameters|Conjecture|Abort)\b' theories/*.v; then
    echo "a proof is not finished"
    exit 1
fi
echo "$closed theorems, all closed under the global context"
