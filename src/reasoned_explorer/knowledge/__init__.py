"""What is known of real places: statistics with their sources, and nothing else. Generator and minds both read it."""
