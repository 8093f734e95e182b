"""What bench dream and the tests of dreams share."""
