"""What is written of an arm: `files` (the folder), `page`, and `corrected_simulation` (the MJCF)."""
