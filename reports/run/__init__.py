"""The whole job, from a suite to results: the only folder that knows both renderers."""
