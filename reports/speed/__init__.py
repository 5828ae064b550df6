"""Speed against error: what a bench records, what it says, and what follows from it."""
