"""Scene data and its algorithms: clouds, cameras, harmonics, files, rendering, language features and groups.

Instructions, plans, language models and sessions belong to the packages above (`tools`, `planners`, `agent`).
"""
