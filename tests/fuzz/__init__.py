"""What strangers' files and unlikely skeletons do: run by hand, and in small by the tests.

`python -m tests.fuzz --minutes 10` reads mutated files; `python -m tests.fuzz.guided` mutates those
on that reach new branches of a reader; `python -m tests.fuzz.geometry` builds degenerate skeletons;
`python -m tests.fuzz.kill` ends programs while they write.
"""
