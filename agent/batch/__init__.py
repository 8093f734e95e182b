"""Many jobs at once: command lines of this program, each done exactly once, in processes here or on Ray.

    jobs.jsonl -> jobs and their keys -> those without a receipt -> workers -> OUT/ID/ and a receipt for each

`jobs` reads and names them, `working` does one, `engines` hands them out, `running` keeps the books, in a folder
(`places`) or by URL (`store`); `resources` are what jobs ask for.
"""
