"""The words that the grammar knows: nouns, verbs, quantities and closed classes."""
