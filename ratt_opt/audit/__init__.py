"""The paper's proof as data, decided by machine: the set-function cone, the entries, the ledger."""
