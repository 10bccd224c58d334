// Never bundled: include_rules.cmake must complain of the second import and not of the first.
import { h } from '../base/dom.js';
import { createStage } from '../scene/stage.js';
