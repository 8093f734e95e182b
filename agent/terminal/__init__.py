"""The terminal: chat, slash commands, completion, tables and output streams."""
