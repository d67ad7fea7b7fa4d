"""Speed against yardsticks, as ratios from one run: `make bench`."""
