"""Large scenes for `bench scale`, and the processes that its memory is measured in."""
