"""Judge an edit from the two clouds: what changed, what the encoder sees there, where things stand, what was left.

Nothing here reads what the edit reports of itself (its receipt, its ids, the table of groups after it).
"""
