"""What was measured, beside what theory predicts."""
