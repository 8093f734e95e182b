"""What a language model is shown: messages, examples, operations and the pruned scene."""
