"""Prompts for language models: messages, examples, operations and the pruned scene."""
