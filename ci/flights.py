"""Exit codes of `vbar run` whose run reached its end, whatever the verdict on its mission."""
COMPLETE = (0, 10, 12)
