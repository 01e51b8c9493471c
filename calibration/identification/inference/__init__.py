"""What a fit is worth: adequacy of the law, intervals, and the verdict."""
