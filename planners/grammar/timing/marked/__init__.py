"""Operations of an instruction whose kind and marks are told: each mark is read by itself and put where its kind
wants it."""
