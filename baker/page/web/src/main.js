import { h } from './base/dom.js';
import { readModel } from './model/model.js';
import { start } from './viewer.js';

const data = JSON.parse(document.getElementById('spherechain-data').textContent);
if (data) start(readModel(data));
else document.body.replaceChildren(h('p', { class: 'template' }, 'This is the template of `spherechain view`: it has no character in it yet.'));
