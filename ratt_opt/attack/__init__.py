"""The attack engine: which values an attack can push a team down to, decided threshold by threshold."""
