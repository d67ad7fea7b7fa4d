"""What only the chapters need: exercises, lesson panels and drawings, and the theses' results."""
