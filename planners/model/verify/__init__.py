"""What a language model answers, validated and checked before it counts."""
