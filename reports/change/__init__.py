"""What changed between two runs: figure by figure, on the same references."""
