"""limits.json: its schema."""

import json

from reports.limits.results import Limits


def test_the_schema_in_the_docs_is_the_schema(request):
    documented = json.loads((request.config.rootpath / "docs/limits.schema.json").read_text())
    assert documented == Limits.model_json_schema()
