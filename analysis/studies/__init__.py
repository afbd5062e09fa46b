"""The engine of all studies: a study is data, run by one engine, stored as one row per trial."""
