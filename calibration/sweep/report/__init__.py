"""What a calibration shows of itself: checks, charts, the page, and the files of its folder."""
